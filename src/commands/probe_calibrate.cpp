// matchlight probe calibrate: how the camera that took the probe differs from the film camera, by the tags.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands/frame_range.h"
#include "commands/probe_commands.h"
#include "commands/probe_options.h"
#include "commands/result.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/version.h"
#include "lighting/probe_file.h"
#include "lighting/probe_record.h"
#include "scene/scene_file.h"
#include "tracking/probe_calibration.h"
#include "tracking/track.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct ProbeCalibrateOptions {
    fs::path scene, output;
    FrameRange frames;
    std::optional<std::int64_t> frame;
    bool white_balance = false;
    bool overwrite = false;
};

/// The probe's light × `gain`, in its own layout, with all that its file says beside the light.
void write_scaled(const ProbeCalibrateOptions& options, const ProbeSettings& settings, const Eigen::Vector3d& gain,
                  const ImageMetadata& said) {
    Warnings said_already;
    said_already.set_quiet(true);
    ProbeImage file = read_probe_image(settings.path, settings.mapping, said_already);
    for (int y = 0; y < file.image.height(); ++y) {
        for (int x = 0; x < file.image.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                file.image.at(x, y, c) = static_cast<float>(
                    std::min(file.image.at(x, y, c) * gain[c], double{std::numeric_limits<float>::max()}));
            }
        }
    }
    ImageMetadata metadata = read_probe_record(settings.path, file).metadata;
    for (const auto& [name, value] : said) metadata[name] = value;
    metadata["software"] = std::string("matchlight ") + version;
    write_probe_image(options.output, file.image, file.layout, metadata, recorded_channels(settings.path, file.layout));
}

json calibration_json(const ProbeCalibration& calibration) {
    json result{{"exposure_ev", calibration.exposure_ev},
                {"white_balance", calibration.white_balance},
                {"channel_ev", calibration.channel_ev},
                {"channel_sigma_ev", calibration.channel_sigma},
                {"frames", calibration.frames},
                {"exposure_over_frames_ev", {calibration.least_ev, calibration.most_ev}},
                {"tags", json::array()}};
    for (const CalibratedTag& tag : calibration.tags) {
        result["tags"].push_back({{"id", tag.id},
                                  {"frames", tag.frames},
                                  {"deviation_ev", tag.deviation_ev},
                                  {"scatter_ev", tag.scatter_ev},
                                  {"sigma_ev", tag.sigma_ev},
                                  {"shown_in_probe", tag.shown_in_probe},
                                  {"out_of_line", tag.out_of_line}});
    }
    return result;
}

std::string calibration_text(const ProbeCalibration& calibration, const fs::path& probe, const fs::path& footage) {
    const auto& wb = calibration.white_balance;
    std::string text = fmt::format(
        "{} = {} × 2^({:+.3f} EV), white balance {:.3f} {:.3f} {:.3f}\n  by channel (r g b): {:+.3f} ± {:.3f}, {:+.3f} "
        "± "
        "{:.3f}, {:+.3f} ± {:.3f} EV\n",
        footage.filename().string(), probe.filename().string(), calibration.exposure_ev, wb[0], wb[1], wb[2],
        calibration.channel_ev[0], calibration.channel_sigma[0], calibration.channel_ev[1],
        calibration.channel_sigma[1], calibration.channel_ev[2], calibration.channel_sigma[2]);
    text += fmt::format("  {} frames, over which the film's exposure runs from {:+.3f} to {:+.3f} EV\n",
                        calibration.frames, calibration.least_ev, calibration.most_ev);
    text += "  tag  frames  deviation EV: r       g       b    scatter  expected\n";
    for (const CalibratedTag& tag : calibration.tags) {
        text += fmt::format("  {:3}  {:6}         {:+7.3f} {:+7.3f} {:+7.3f} {:8.3f}  ± {:.3f}  {}{}\n", tag.id,
                            tag.frames, tag.deviation_ev[0], tag.deviation_ev[1], tag.deviation_ev[2], tag.scatter_ev,
                            tag.sigma_ev, tag.shown_in_probe ? "seen in the probe" : "by its albedo",
                            tag.out_of_line ? "  <- out of line" : "");
    }
    return text;
}

void warn_of_doubts(const ProbeCalibration& calibration, const Scene& scene, const TrackDetails& details,
                    Warnings& warnings, json& result) {
    const fs::path& probe = scene.probe->path;
    std::vector<int> out_of_line;
    int shown = 0;
    for (const CalibratedTag& tag : calibration.tags) {
        if (tag.out_of_line) out_of_line.push_back(tag.id);
        shown += tag.shown_in_probe;
    }
    if (!out_of_line.empty()) {
        warnings.add(
            fmt::format("{}: its light does not fit tags {}: they differ from the others by more than their noise; the "
                        "probe may be "
                        "turned wrongly, of other light, or the tags in a shadow or misplaced",
                        probe.string(), fmt::join(out_of_line, ", ")));
    }
    if (calibration.tags.size() == 1) {
        warnings.add(fmt::format("{}: one tag alone cannot tell whether the probe is right", probe.string()));
    }
    result["consistent"] = out_of_line.empty();
    result["tags_in_probe"] = shown;
    if (!scene.probe->place_m || shown == static_cast<int>(calibration.tags.size())) return;
    Warnings said_already;
    said_already.set_quiet(true);
    const Probe placed_probe = placed(load_probe(probe, scene.probe->mapping, said_already), scene.probe->placement);
    const auto turn = better_turn(scene, placed_probe, details);
    if (!turn) return;
    double rotation_deg = std::fmod(scene.probe->placement.rotation_deg + turn->turn_deg, 360.0);
    if (rotation_deg > 180) rotation_deg -= 360;
    result["better_rotation_deg"] = rotation_deg;
    warnings.add(
        fmt::format("{}: shows {} of the tags where they are; turned to rotation_deg = {:.0f} it would show {}",
                    probe.string(), shown, rotation_deg, turn->tags_shown));
}

void check_call(const ProbeCalibrateOptions& options, const Scene& scene) {
    if (scene.camera) throw InputError(options.scene, "has no footage to calibrate a probe against");
    if (!scene.probe) {
        throw InputError(options.scene, "names no light probe", "give one: [light] probe = \"room.exr\"");
    }
    if (options.output.empty()) return;
    std::error_code error;
    if (fs::equivalent(scene.probe->path, options.output, error)) {
        throw InputError(options.output, "the output is the scene's own probe", "give another name");
    }
    require_probe_extension(options.output);
    check_output(options.output, options.overwrite);
}

void run_calibrate(const ProbeCalibrateOptions& options, CommandContext& context) {
    const Scene scene = load_scene(options.scene, context.warnings);
    check_call(options, scene);
    std::optional<OutputLock> lock;
    if (!options.output.empty()) lock.emplace(options.output);
    TrackOptions tracking;
    tracking.level = TrackLevel::normal;  // what it leaves of the pose moves no tag's light
    tracking.first_frame = options.frames.first;
    tracking.last_frame = options.frames.last;
    tracking.quiet = context.quiet;
    TrackDetails details;
    TrackSummary summary;
    summary.details = &details;
    const Solve solve = track_footage(scene, tracking, context.warnings, summary);
    const auto calibration = calibrate_probe(solve, details, options.frame);
    if (!calibration) {
        throw InputError(scene.footage.video,
                         options.frame ? fmt::format("no tag can be read as a grey card in frame {}", *options.frame)
                                       : std::string("no tag can be read as a grey card"),
                         "film a tag large enough and not clipped");
    }

    json result = calibration_json(*calibration);
    std::string text = calibration_text(*calibration, scene.probe->path, scene.footage.video);
    warn_of_doubts(*calibration, scene, details, context.warnings, result);
    if (!options.output.empty()) {
        const double exposure_ev = scene.probe->placement.exposure_ev + calibration->exposure_ev;
        Eigen::Vector3d gain = Eigen::Vector3d::Constant(std::exp2(exposure_ev));
        const auto& wb = calibration->white_balance;
        if (options.white_balance) gain = gain.cwiseProduct(Eigen::Vector3d(wb[0], wb[1], wb[2]));
        write_scaled(options, *scene.probe, gain,
                     {{"calibrated_against", scene.footage.video.filename().string()},
                      {"calibrated_gain", fmt::format("{} {} {}", gain.x(), gain.y(), gain.z())}});
        result["file"] = options.output.string();
        result["gain"] = rgb_json(gain);
        text += fmt::format("{}: the probe × {:.4g} {:.4g} {:.4g}; in the scene, leave out exposure_ev\n",
                            options.output.string(), gain.x(), gain.y(), gain.z());
    }
    print_result(context, result, text);
}

}  // namespace

void add_probe_calibrate_command(CLI::App& probe, CommandContext& context) {
    CLI::App* command = probe.add_subcommand(
        "calibrate", "Exposure and white balance between the probe's camera and the film camera, by the tags");
    const auto options = std::make_shared<ProbeCalibrateOptions>();
    command->add_option("SCENE", options->scene, "Scene file (.toml) with footage, tags and a probe")->required();
    command->add_option("-o,--output", options->output,
                        "Also write the probe scaled so that the film's exposure becomes 0 EV: .exr or .hdr");
    command->add_flag("--white-balance", options->white_balance,
                      "Tint the written probe, too, so that the film becomes neutral");
    add_frames_option(*command, options->frames);
    command->add_option("--frame", options->frame, "The frame whose exposure counts (default: the median of all)")
        ->check(CLI::NonNegativeNumber);
    command->add_flag("--overwrite", options->overwrite, "Replace a file that exists");
    command->callback([options, &context] { run_calibrate(*options, context); });
}

}  // namespace matchlight
