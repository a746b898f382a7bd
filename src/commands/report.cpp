// `matchlight report`: error against run time of every effect on a frame of a scene.
#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commands/command.h"
#include "commands/result.h"
#include "core/error.h"
#include "core/progress.h"
#include "core/stop.h"
#include "core/version.h"
#include "gl/bandwidth.h"
#include "gl/context.h"
#include "media/image_io.h"
#include "report/budgets.h"
#include "report/depth_of_field_timing.h"
#include "report/experiments.h"
#include "report/machine_calibration.h"
#include "report/probe_experiments.h"
#include "report/report_folder.h"
#include "report/sphere_experiment.h"
#include "report/stability_cases.h"
#include "report/track_experiment.h"
#include "report/track_text.h"
#include "report/truth.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
    std::string scene, output, truth, study;
    std::optional<std::int64_t> frame;
    std::vector<std::string> effects;  // all when empty
    std::vector<std::string> parts;    // of the table of stability, or of what is measured of spheres; all when empty
    std::vector<std::string> spheres;
    std::size_t orbit_frames = 0;  // 0: 180, or 6 when quick
    int repeats = 0;               // 0: seven, or three when quick
    bool quick = false, overwrite = false, stability = false, calibrate_machine = false, track = false, probes = false;

    TimingOptions timing() const {
        TimingOptions timing;
        timing.repeats = repeats > 0 ? repeats : quick ? 3 : 7;
        return timing;
    }
};

Machine this_machine(GlContext& context) {
    return {.renderer = context.info().renderer,
            .gl_version = context.info().version,
            .timer_queries = context.timer_queries_are_reliable(),
            .cores = std::thread::hardware_concurrency(),
            .copy_bytes_per_second = copy_bytes_per_second()};
}

Image8 truth_of(const std::string& pattern, const PlateFrame& plate) {
    const fs::path path = numbered(pattern, plate.index());
    Image8 truth = read_rgb8(path);
    const PlateFormat& format = plate.format();
    if (truth.width() == format.width && truth.height() == format.height) return truth;
    throw InputError(
        path, fmt::format("is {}x{}, the footage is {}x{}", truth.width(), truth.height(), format.width, format.height),
        "give pictures of the footage's size");
}

std::string effect_lines(const Report& report) {
    std::string text;
    for (const EffectReport& effect : report.effects) {
        text += fmt::format("{} (ms once a {})", effect.name, effect.unit == WorkUnit::frame ? "frame" : "clip");
        if (!effect.left_out_of_frame.empty()) {
            text += fmt::format(": left out: {}\n", effect.left_out_of_frame);
            continue;
        }
        if (effect.reference_self_error_flip) {
            text += fmt::format(", reference's own error {:.2g}", *effect.reference_self_error_flip);
        }
        text += "\n";
        for (const EffectPoint& point : effect.points) {
            text += fmt::format("  {:<18}{:>10.3g} ms", point.level, point.time.median_ms);
            if (point.errors.flip) text += fmt::format("   FLIP {:.5f}", *point.errors.flip);
            if (point.errors.hdr_flip) text += fmt::format("   HDR-FLIP {:.5f}", *point.errors.hdr_flip);
            if (point.errors.mean_light) text += fmt::format("   mean light {:+.2g}", *point.errors.mean_light);
            text += "\n";
        }
        if (const auto& left_out = effect.left_out) {
            text += fmt::format("  {:<18}{:>10.3g} ms saved   largest difference {} codes", "left out",
                                left_out->ms_saved, left_out->max_code_difference);
            text += left_out->cost.empty() ? "\n" : fmt::format("; costs {}\n", knobs_text(left_out->cost));
        }
    }
    for (const TruthRow& row : report.truth) {
        text += fmt::format("against the truth, {:<10}{:>10.3g} ms   FLIP inside {:.4f}\n", row.level,
                            row.time.median_ms, row.flip_in.value_or(0));
    }
    for (const BudgetRow& row : report.budget) {
        text += fmt::format("budget {:>8.4g} ms: predicted {:.4g} ms, measured {:.4g} ms ({})\n", row.budget_ms,
                            row.predicted_ms, row.measured_ms, row.choice);
    }
    return text;
}

void measure_scene(const ReportArguments& arguments, GlContext& gl, CommandContext& context, Report& report) {
    const Scene scene = load_scene(arguments.scene, context.warnings);
    SceneStage stage(gl, scene, arguments.frame, context.warnings);
    std::optional<Image8> truth;
    if (!arguments.truth.empty()) truth = truth_of(arguments.truth, *stage.plate);
    report.scene = scene.path.filename().string();
    report.frame = stage.plate->index();
    report.width = stage.plate->format().width;
    report.height = stage.plate->format().height;
    report.provenance = fmt::format("matchlight {}\n{}", version, scene.effective_toml);

    const ExperimentOptions options{.quick = arguments.quick, .by_name = !arguments.effects.empty()};
    const TimingOptions timing = arguments.timing();
    Progress progress("report", static_cast<std::int64_t>(all_experiments().size()) + (truth ? 1 : 0), context.quiet);
    for (const NamedExperiment& named : all_experiments()) {
        if (stop_requested()) throw InputError(arguments.output, "stopped by a signal");
        const bool wanted = arguments.effects.empty() || std::ranges::count(arguments.effects, named.name) > 0;
        if (const std::optional<Experiment> experiment = wanted ? named.make(stage, options) : std::nullopt) {
            report.effects.push_back(run_experiment(
                *experiment, [&stage](const ImageF& light) { return stage.code_of(light); }, timing));
        }
        progress.advance();
    }
    if (truth) {
        report.truth = frame_error_against_truth(stage, *truth, options, timing);
        progress.advance();
    }
    report.budget = budgets_predicted_and_measured(stage, timing);
}

void measure_probes(const ReportArguments& arguments, CommandContext& context, Report& report) {
    Progress progress("probes", static_cast<std::int64_t>(2 * probe_experiment_count), context.quiet);
    report.provenance = fmt::format("matchlight {}", version);
    for (const Experiment& experiment : probe_experiments([&progress] { progress.advance(); })) {
        if (stop_requested()) throw InputError(arguments.output, "stopped by a signal");
        report.effects.push_back(run_experiment(experiment, probe_codes, arguments.timing()));
        progress.advance();
    }
}

/// Measures this machine and writes the table that budgets are kept by.
void calibrate(const ReportArguments& arguments, CommandContext& context) {
    const auto path = level_table_path();
    if (!path) throw InputError("", "neither XDG_CACHE_HOME nor HOME says where the table of levels goes", "set one");
    const std::unique_ptr<GlContext> gl = create_offscreen_context();
    Progress progress("calibrate", calibration_steps(), context.quiet);
    const LevelTable table = calibrate_machine(*gl, arguments.timing(), [&] { progress.advance(); });
    save_level_table(*path, table, context.warnings);
    nlohmann::json json{{"table", path->string()}, {"effects", nlohmann::json::object()}};
    std::string text = fmt::format("{}\n", path->string());
    for (const auto& [effect, levels] : table.effects) {
        for (const LevelCost& cost : levels) {
            json["effects"][effect].push_back({{"level", cost.level},
                                               {"fixed_ms", cost.fixed_ms},
                                               {"ms_per_megapixel", cost.ms_per_megapixel},
                                               {"flip", cost.flip}});
            text += fmt::format("  {:<10}{:<12}{:>9.3g} ms + {:>8.3g} ms a megapixel   FLIP {:.5f}\n", effect,
                                cost.level, cost.fixed_ms, cost.ms_per_megapixel, cost.flip);
        }
    }
    print_result(context, json, text);
}

void measure_track(const ReportArguments& arguments, CommandContext& context, Report& report) {
    const Scene scene = load_scene(arguments.scene, context.warnings);
    if (scene.camera) {
        throw InputError(scene.path, "has a camera of its own: there is no footage to track");
    }
    TrackExperimentOptions options;
    options.repeats = arguments.repeats > 0 ? arguments.repeats : arguments.quick ? 1 : 3;
    if (!arguments.truth.empty()) options.truth = arguments.truth;
    Progress progress("track", track_experiment_steps(options), context.quiet);
    options.advance = [&progress] { progress.advance(); };
    report.scene = scene.path.filename().string();
    report.provenance = fmt::format("matchlight {}\n{}", version, scene.effective_toml);
    report.track = run_track_experiment(scene, options, context.warnings);
}

void measure_study(const ReportArguments& arguments, GlContext& gl, CommandContext& context, Report& report) {
    const Scene scene = load_scene(arguments.scene, context.warnings);
    Progress progress("study", static_cast<std::int64_t>(depth_of_field_study_steps()), context.quiet);
    report.scene = scene.path.filename().string();
    report.provenance = fmt::format("matchlight {}\n{}", version, scene.effective_toml);
    report.depth_of_field_study = measure_depth_of_field_study(
        gl, scene,
        {.frame = arguments.frame, .timing = arguments.timing(), .advance = [&progress] { progress.advance(); }},
        context.warnings);
}

void measure_sphere_sets(const ReportArguments& arguments, CommandContext& context, Report& report) {
    Progress progress("spheres", static_cast<std::int64_t>(sphere_experiment_steps(arguments.spheres.size())),
                      context.quiet);
    SphereExperimentOptions options;
    options.frames = arguments.orbit_frames > 0 ? arguments.orbit_frames : arguments.quick ? 6 : 180;
    options.repeats = std::max(arguments.repeats, 1);
    options.quick = arguments.quick;
    for (const std::string& part : arguments.parts) {
        if (std::ranges::find(sphere_experiment_parts, part) != sphere_experiment_parts.end()) continue;
        throw InputError("--parts", fmt::format("nothing that is measured of spheres is called \"{}\"", part),
                         fmt::format("name some of: {}", fmt::join(sphere_experiment_parts, "; ")));
    }
    options.parts = arguments.parts;
    if (arguments.quick) options.side_px = 512;
    options.advance = [&progress] { progress.advance(); };
    measure_spheres(arguments.spheres, options, context.warnings, report);
    report.provenance = fmt::format("matchlight {}\n", version);
}

/// The table's cases, of the parts asked for.
std::vector<StabilityCase> cases_of(const ReportArguments& arguments) {
    std::vector<StabilityCase> cases = stability_cases(arguments.quick);
    for (const std::string& part : arguments.parts) {
        if (std::ranges::find(cases, part, &StabilityCase::effect) != cases.end()) continue;
        std::set<std::string> known;
        for (const StabilityCase& each : cases) known.insert(each.effect);
        throw InputError("--parts", fmt::format("the table of stability has no part \"{}\"", part),
                         fmt::format("name some of: {}", fmt::join(known, "; ")));
    }
    if (!arguments.parts.empty()) {
        std::erase_if(cases, [&](const StabilityCase& each) {
            return std::ranges::find(arguments.parts, each.effect) == arguments.parts.end();
        });
    }
    return cases;
}

void run_stability_cases(const ReportArguments& arguments, CommandContext& context, Report& report) {
    const std::vector<StabilityCase> cases = cases_of(arguments);
    Progress progress("stability", static_cast<std::int64_t>(cases.size()), context.quiet);
    for (const StabilityCase& tried : cases) {
        if (stop_requested()) throw InputError("", "stopped by a signal");
        report.stability.push_back(stability_row(tried));
        progress.advance();
    }
}

std::string stability_lines(const Report& report) {
    std::string text;
    for (const StabilityRow& row : report.stability) {
        text += fmt::format("{} {:<15} {}: {:.4g} ({}", row.pass ? "pass" : "FAIL", row.effect, row.name, row.value,
                            row.bound);
        if (row.energy_kept) text += fmt::format("; {:.6g} kept", *row.energy_kept);
        if (!row.beside.empty()) text += "; beside: " + knobs_text(row.beside);
        text += ")\n";
    }
    return text;
}

void make_report(const ReportArguments& arguments, CommandContext& context) {
    const ReportFolder folder(arguments.output, arguments.overwrite);
    const std::unique_ptr<GlContext> gl = create_offscreen_context();
    Report report;
    report.machine = this_machine(*gl);
    if (arguments.track) {
        measure_track(arguments, context, report);
    } else if (!arguments.study.empty()) {
        measure_study(arguments, *gl, context, report);
    } else if (!arguments.spheres.empty()) {
        measure_sphere_sets(arguments, context, report);
    } else if (arguments.probes) {
        measure_probes(arguments, context, report);
    } else if (!arguments.scene.empty()) {
        measure_scene(arguments, *gl, context, report);
    }
    if (arguments.stability) run_stability_cases(arguments, context, report);
    folder.write(report);
    print_result(context, nlohmann::json::parse(report_json(report)),
                 (report.track ? track_lines(*report.track) : effect_lines(report)) +
                     (arguments.study.empty() ? "" : depth_of_field_study_lines(report.depth_of_field_study)) +
                     (report.sphere_study.empty() ? "" : sphere_study_lines(report.sphere_study)) +
                     stability_lines(report) + fmt::format("{}\n", folder.page().string()));
    const auto failed = std::ranges::count_if(report.stability, [](const StabilityRow& row) { return !row.pass; });
    if (failed > 0) {
        throw InputError(folder.page(), fmt::format("{} of {} cases of stability leave their bounds", failed,
                                                    report.stability.size()));
    }
}

}  // namespace

void add_report_command(CLI::App& app, CommandContext& context) {
    CLI::App* command = app.add_subcommand("report", "Error against run time of every effect: HTML, CSV, JSON");
    const auto arguments = std::make_shared<ReportArguments>();
    command->add_option("scene", arguments->scene, "Scene file, tracked (none with --stability alone)")
        ->type_name("SCENE.toml");
    command->add_option("-o,--output", arguments->output, "Folder for report.html, report.csv and report.json")
        ->type_name("DIR");
    command->add_option("--frame", arguments->frame, "Frame to measure (the first that has a pose)")
        ->check(CLI::NonNegativeNumber);
    std::vector<std::string> names;
    for (const NamedExperiment& named : all_experiments()) names.push_back(named.name);
    command->add_option("--effects", arguments->effects, "Only these, separated by commas")
        ->delimiter(',')
        ->check(CLI::IsMember(names));
    command
        ->add_option("--repeats", arguments->repeats,
                     "Timed runs of each level and knob (7; 3 with --quick; with --track 3 and 1)")
        ->check(CLI::Range(1, 1000));
    command->add_option(
        "--truth", arguments->truth,
        "Pictures with the objects really there (truth_%03d.png): also measure whole frames against them; with --track "
        "the groundtruth.json of a made clip");
    command->add_flag(
        "--track", arguments->track,
        "Track the footage at every level and with other libraries' poses: error against run time, or how "
        "well the tags agree where no truth is given");
    command
        ->add_option("--study", arguments->study,
                     "\"depth\": what a frame costs with depth of field and without, by each method at 512x512, "
                     "1024x512 and 1024x1024; for scenes without footage")
        ->check(CLI::IsMember({"depth"}));
    command
        ->add_option("--spheres", arguments->spheres,
                     "Sphere sets, separated by commas: files, or C1 to C4 as `spheres generate` makes them. What a "
                     "frame of an orbit costs by each way of drawing, and how far it is from rays in double precision")
        ->delimiter(',')
        ->type_name("SETS");
    command->add_option("--frames", arguments->orbit_frames, "Of the orbit around each set (180; 6 with --quick)")
        ->check(CLI::Range(1, 10000));
    command->add_flag("--probes", arguments->probes,
                      "What making a light probe costs, against rooms in double precision: merging photographs, "
                      "unwrapping a ball, parallax, mappings");
    command->add_flag("--stability", arguments->stability,
                      "A table of stiff and extreme cases: what came out of each, against its bound");
    command
        ->add_option("--parts", arguments->parts,
                     "Of --stability: only these parts of the table (\"bloom, pyramid\"), separated by semicolons; of "
                     "--spheres: visibility, light, maps, rays, edges, detail, occlusion, halos, transparency")
        ->delimiter(';');
    command->add_flag("--calibrate-machine", arguments->calibrate_machine,
                      "Measure what every level costs on this machine, once, for scenes with budget_ms: the table goes "
                      "into the user's cache folder");
    command->add_flag("--quick", arguments->quick, "Fewer knobs and cheaper references: some seconds an effect");
    command->add_flag("--overwrite", arguments->overwrite, "Replace a report that exists");
    command->callback([arguments, &context] {
        const bool reports =
            !arguments->scene.empty() || !arguments->spheres.empty() || arguments->stability || arguments->probes;
        if (!reports && !arguments->calibrate_machine) {
            throw CLI::RequiredError("SCENE.toml, --spheres, --probes, --stability or --calibrate-machine");
        }
        const bool needs_scene = arguments->track || !arguments->study.empty();
        if (needs_scene && arguments->scene.empty()) throw CLI::RequiredError("SCENE.toml");
        if (!arguments->spheres.empty() && !arguments->scene.empty())
            throw CLI::ExcludesError("--spheres", "SCENE.toml");
        if (arguments->probes && !(arguments->scene.empty() && arguments->spheres.empty()))
            throw CLI::ExcludesError("--probes", "SCENE.toml and --spheres");
        if (arguments->orbit_frames > 0 && arguments->spheres.empty())
            throw CLI::RequiresError("--frames", "--spheres");
        if (arguments->track && !arguments->study.empty()) throw CLI::ExcludesError("--track", "--study");
        if (reports && arguments->output.empty()) throw CLI::RequiredError("--output");
        // Each has parts of its own.
        if (!arguments->parts.empty() && arguments->stability == !arguments->spheres.empty())
            throw CLI::RequiresError("--parts", "one of --stability and --spheres");
        if (arguments->calibrate_machine) calibrate(*arguments, context);
        if (reports) make_report(*arguments, context);
    });
}

}  // namespace matchlight
