// matchlight track: from footage and its tags to a solve.
#include "tracking/track.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands/command.h"
#include "commands/frame_range.h"
#include "commands/result.h"
#include "core/atomic_file.h"
#include "core/elapsed.h"
#include "core/error.h"
#include "core/output_folder.h"
#include "report/solve_page.h"
#include "scene/scene_file.h"
#include "tracking/solve_file.h"
#include "tracking/track_details.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Where the page goes: an .html file, or solve.html in a folder; checked before the long work.
class SolvePageFile {
public:
    SolvePageFile(const fs::path& place, bool overwrite) {
        if (place.extension() == ".html") {
            path_ = place;
            check_output(path_, overwrite);
            lock_.emplace(path_);
        } else {
            folder_.emplace(place, std::vector<std::string>{"solve.html"}, overwrite);
            path_ = place / "solve.html";
        }
    }
    void write(const std::string& html) const {
        if (folder_) {
            folder_->write({html});
        } else {
            write_text_file(path_, html);
        }
    }
    const fs::path& path() const { return path_; }

private:
    fs::path path_;
    std::optional<OutputLock> lock_;
    std::optional<OutputFolder> folder_;
};

struct TrackCall {
    fs::path scene;
    std::optional<fs::path> output, report;
    FrameRange frames;
    TrackLevel level = TrackLevel::final_;
    CornerMethod corners = CornerMethod::fit;
    bool overwrite = false, strict = false;
};

json optics_json(const OpticsSummary& optics) {
    json object = json::object();
    const auto put = [&](const char* key, const std::optional<double>& value) {
        if (value) object[key] = *value;
    };
    put("coc_scale_px_m", optics.coc_scale_px_m);
    put("coc_scale_sigma", optics.coc_scale_sigma);
    if (!optics.focus_m.empty()) {
        const auto [nearest, farthest] = std::minmax_element(optics.focus_m.begin(), optics.focus_m.end());
        object["focus_m"] = {{"nearest", *nearest}, {"farthest", *farthest}, {"frames", optics.focus_m.size()}};
    }
    put("shutter_fraction", optics.shutter_fraction);
    put("shutter_sigma", optics.shutter_sigma);
    put("softness_px", optics.softness_px);
    if (!optics.focus_unknown.empty()) object["focus_unknown"] = optics.focus_unknown;
    if (!optics.shutter_unknown.empty()) object["shutter_unknown"] = optics.shutter_unknown;
    return object;
}

std::string optics_text(const OpticsSummary& optics) {
    std::string text = "  optics: ";
    if (optics.focus_m.empty()) {
        text += fmt::format("focus not known ({})",
                            optics.focus_unknown.empty() ? "too uncertain in every frame" : optics.focus_unknown);
    } else {
        const auto [nearest, farthest] = std::minmax_element(optics.focus_m.begin(), optics.focus_m.end());
        text += fmt::format("focus {:.3f} to {:.3f} m, circle of confusion {:.2f} ± {:.2f} px m", *nearest, *farthest,
                            *optics.coc_scale_px_m, *optics.coc_scale_sigma);
    }
    text += optics.shutter_fraction
                ? fmt::format("; shutter {:.2f} ± {:.2f} of a frame", *optics.shutter_fraction, *optics.shutter_sigma)
                : fmt::format("; shutter not known ({})", optics.shutter_unknown);
    if (optics.softness_px) text += fmt::format("; softness {:.2f} px", *optics.softness_px);
    return text + "\n";
}

json counts_json(const std::map<int, std::int64_t>& counts) {
    json object = json::object();
    for (const auto& [id, count] : counts) object[std::to_string(id)] = count;
    return object;
}

template <class Value>
json or_null(const std::optional<Value>& value) {
    return value ? json(*value) : json(nullptr);
}

json photometry_json(const Solve& solve, const PhotometrySummary& told) {
    json object{{"frames_measured", told.measured},     {"frames_interpolated", told.interpolated},
                {"tags_in_probe", told.tags_in_probe},  {"exposure_range_ev", told.exposure_range_ev},
                {"response", solve.response.to_json()}, {"response_solved", told.response_solved},
                {"vignette", or_null(solve.vignette)},  {"vignette_corner_sigma", or_null(told.vignette_corner_sigma)}};
    object["noise"] = nullptr;
    if (solve.noise) {
        object["noise"] = {{"read", (*solve.noise)[0]},
                           {"shot", (*solve.noise)[1]},
                           {"relative_error", or_null(told.noise_relative_error)},
                           {"neighbour_correlation", or_null(told.noise_neighbour_correlation)}};
    }
    object["light_gradient_ev_per_m"] = nullptr;
    if (solve.light_gradient_ev_per_m) {
        const Eigen::Vector3d& gradient = *solve.light_gradient_ev_per_m;
        object["light_gradient_ev_per_m"] = {gradient.x(), gradient.y(), gradient.z()};
    }
    return object;
}

std::string photometry_text(const Solve& solve, const PhotometrySummary& told) {
    std::string text = fmt::format("  light: exposure measured in {} frames", told.measured);
    if (told.interpolated > 0) text += fmt::format(", interpolated in {}", told.interpolated);
    if (told.response_solved) text += fmt::format("; response {}", solve.response.to_json().dump());
    if (solve.vignette) {
        const auto& vignette = *solve.vignette;
        text += fmt::format("; corners {:.0f} % (±{:.0f}) of the middle's light", 100 * (1 + vignette[0] + vignette[1]),
                            100 * told.vignette_corner_sigma.value_or(0));
    } else {
        text += "; fall-off to the corners not known";
    }
    if (solve.noise) {
        const auto& noise = *solve.noise;
        text += fmt::format("; noise {:.2f} % of white at light 0.5",
                            100 * std::sqrt(noise[0] * noise[0] + 0.5 * noise[1]));
    }
    return text + "\n";
}

void run_track(const TrackCall& call, CommandContext& context) {
    const Scene scene = load_scene(call.scene, context.warnings);
    if (scene.camera) {
        throw InputError(call.scene, "has a camera of its own and needs no track",
                         fmt::format("render it: matchlight render {} -o OUT", call.scene.string()));
    }
    // The scene's own solve is an artefact that track keeps up to date; a file named by hand may be something else.
    const fs::path output = call.output.value_or(scene.footage.solve);
    check_output(output, call.overwrite || !call.output);
    const OutputLock lock(output);
    std::optional<SolvePageFile> page;
    if (call.report) page.emplace(*call.report, call.overwrite);

    TrackOptions options;
    options.level = call.level;
    options.corners = call.corners;
    options.first_frame = call.frames.first;
    options.last_frame = call.frames.last;
    options.strict = call.strict;
    options.quiet = context.quiet;
    TrackSummary summary;
    TrackDetails details;
    if (page) summary.details = &details;
    const auto start = std::chrono::steady_clock::now();
    const Solve solve = track_footage(scene, options, context.warnings, summary);
    save_solve(output, solve);
    if (page) page->write(solve_page_html(scene, solve, details, context.warnings));
    const double seconds = seconds_since(start);

    json result{{"solve", output.string()},
                {"frames", summary.frames},
                {"posed", summary.posed},
                {"bridged", summary.bridged},
                {"missing", summary.missing},
                {"reprojection_px", {{"mean", summary.mean_reprojection_px}, {"worst", summary.worst_reprojection_px}}},
                {"frames_by_tag", counts_json(summary.frames_by_tag)},
                {"ids_outside_the_rig", counts_json(summary.foreign_ids)},
                {"exposure_from_probe", summary.exposure_from_probe},
                {"photometry", photometry_json(solve, summary.photometry)},
                {"leave_one_out_px", summary.leave_one_out_px ? json(*summary.leave_one_out_px) : json(nullptr)},
                {"notes", summary.notes},
                {"optics", optics_json(summary.optics)},
                {"seconds", seconds}};
    std::string text = fmt::format(
        "{}: {} of {} frames have a pose ({} bridged), reprojection {:.3f} px mean, {:.3f} worst\n", output.string(),
        summary.posed, summary.frames, summary.bridged, summary.mean_reprojection_px, summary.worst_reprojection_px);
    for (const auto& [id, count] : summary.frames_by_tag) text += fmt::format("  tag {}: {} frames\n", id, count);
    text += photometry_text(solve, summary.photometry);
    if (summary.leave_one_out_px) {
        text += fmt::format("  tags as the others predict them: {:.3f} px median\n", *summary.leave_one_out_px);
    }
    for (const std::string& note : summary.notes) text += fmt::format("  {}\n", note);
    text += optics_text(summary.optics);
    if (page) {
        result["report"] = page->path().string();
        text += fmt::format("{}\n", page->path().string());
    }
    print_result(context, result, text);
}

}  // namespace

void add_track_command(CLI::App& app, CommandContext& context) {
    CLI::App* command = app.add_subcommand("track", "Pose, exposure and white balance of every frame, from the tags");
    const auto call = std::make_shared<TrackCall>();
    command->add_option("SCENE", call->scene, "Scene file (.toml)")->required();
    command->add_option("-o,--output", call->output,
                        "Solve file; unless given, the scene's own, which is replaced without asking");
    add_frames_option(*command, call->frames);
    const std::map<std::string, TrackLevel> levels{
        {"fast", TrackLevel::fast}, {"normal", TrackLevel::normal}, {"final", TrackLevel::final_}};
    command
        ->add_option("--level", call->level,
                     "How much is done for the pose: fast keeps up with footage, final is the best (default)")
        ->transform(CLI::CheckedTransformer(levels).description("{fast,normal,final}"));
    const std::map<std::string, CornerMethod> methods{{"apriltag", CornerMethod::apriltag}, {"fit", CornerMethod::fit}};
    command
        ->add_option("--corners", call->corners,
                     "Where corners come from: AprilTag's library, or the fit of the tags' image (default)")
        ->transform(CLI::CheckedTransformer(methods).description("{apriltag,fit}"));
    command
        ->add_option(
            "--report", call->report,
            "Also write a page of the solve: flagged frames first, path, residuals, what the camera did; an .html "
            "file, or a folder for solve.html")
        ->type_name("DIR");
    command->add_flag("--overwrite", call->overwrite, "Replace the files named by --output and --report");
    command->add_flag("--strict", call->strict, "Damaged or truncated footage is an error");
    command->callback([call, &context] { run_track(*call, context); });
}

}  // namespace matchlight
