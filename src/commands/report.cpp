// `matchlight report`: error against run time of every effect on a frame of a scene.
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands/command.h"
#include "commands/result.h"
#include "core/error.h"
#include "core/progress.h"
#include "core/stop.h"
#include "core/version.h"
#include "gl/bandwidth.h"
#include "gl/context.h"
#include "media/image_io.h"
#include "report/experiments.h"
#include "report/report_folder.h"
#include "report/stability_cases.h"
#include "report/truth.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
    std::string scene, output, truth;
    std::optional<std::int64_t> frame;
    std::vector<std::string> effects;  // all when empty
    int repeats = 0;                   // 0: seven, or three when quick
    bool quick = false, overwrite = false, stability = false;
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
            text += "\n";
        }
        if (const auto& left_out = effect.left_out) {
            text += fmt::format("  {:<18}{:>10.3g} ms saved   largest difference {} codes\n", "left out",
                                left_out->ms_saved, left_out->max_code_difference);
        }
    }
    for (const TruthRow& row : report.truth) {
        text += fmt::format("against the truth, {:<10}{:>10.3g} ms   FLIP inside {:.4f}\n", row.level,
                            row.time.median_ms, row.flip_in.value_or(0));
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
    TimingOptions timing;
    timing.repeats = arguments.repeats > 0 ? arguments.repeats : arguments.quick ? 3 : 7;
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
}

void run_stability_cases(CommandContext& context, Report& report) {
    const std::vector<StabilityCase> cases = stability_cases();
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
        text += row.energy_kept ? fmt::format("; {:.6g} kept)\n", *row.energy_kept) : ")\n";
    }
    return text;
}

void make_report(const ReportArguments& arguments, CommandContext& context) {
    const ReportFolder folder(arguments.output, arguments.overwrite);
    const std::unique_ptr<GlContext> gl = create_offscreen_context();
    Report report;
    report.machine = this_machine(*gl);
    if (!arguments.scene.empty()) measure_scene(arguments, *gl, context, report);
    if (arguments.stability) run_stability_cases(context, report);
    folder.write(report);
    print_result(context, nlohmann::json::parse(report_json(report)),
                 effect_lines(report) + stability_lines(report) + fmt::format("{}\n", folder.page().string()));
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
        ->required()
        ->type_name("DIR");
    command->add_option("--frame", arguments->frame, "Frame to measure (the first that has a pose)")
        ->check(CLI::NonNegativeNumber);
    std::vector<std::string> names;
    for (const NamedExperiment& named : all_experiments()) names.push_back(named.name);
    command->add_option("--effects", arguments->effects, "Only these, separated by commas")
        ->delimiter(',')
        ->check(CLI::IsMember(names));
    command->add_option("--repeats", arguments->repeats, "Timed runs of each level and knob (7; 3 with --quick)")
        ->check(CLI::Range(1, 1000));
    command->add_option(
        "--truth", arguments->truth,
        "Pictures with the objects really there (truth_%03d.png): also measure whole frames against them");
    command->add_flag("--stability", arguments->stability,
                      "A table of stiff and extreme cases: what came out of each, against its bound");
    command->add_flag("--quick", arguments->quick, "Fewer knobs and cheaper references: some seconds an effect");
    command->add_flag("--overwrite", arguments->overwrite, "Replace a report that exists");
    command->callback([arguments, &context] {
        if (arguments->scene.empty() && !arguments->stability) throw CLI::RequiredError("SCENE.toml or --stability");
        make_report(*arguments, context);
    });
}

}  // namespace matchlight
