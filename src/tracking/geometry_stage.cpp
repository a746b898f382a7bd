// Rig and path one after the other, and what is said of them.
#include "tracking/geometry_stage.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"
#include "core/median.h"
#include "tracking/clip_refinement.h"
#include "tracking/lens_projection.h"
#include "tracking/lens_start.h"

namespace matchlight {

namespace {

void warn_of_rig(const ClipContext& context, const RigSolution& rig) {
    if (!rig.unplaced.empty()) {
        context.warnings.add(
            fmt::format("{}: tags {} are never seen together with a tag whose place is known: left out",
                        context.scene.footage.video.string(), fmt::join(rig.unplaced, ", ")));
    }
    constexpr double inconsistent = 5;  // standard deviations
    if (rig.rms > inconsistent) {
        context.warnings.add(
            fmt::format("{}: the tags do not keep one rigid arrangement, or a size or the lens is wrong "
                        "(residuals {:.0f} times their expected spread)",
                        context.scene.footage.video.string(), rig.rms));
    }
}

/// "cx 962.70 → 962.79 ± 0.05 px": what the clip changed of the calibrated lens.
std::string refined_lens(const ClipContext& context, const GeometrySolution& geometry) {
    std::vector<std::string> changes;
    const LensVector before = lens_vector(context.camera), after = lens_vector(geometry.camera);
    for (const LensParameter& parameter : geometry.lens_parameters) {
        const auto name = std::ranges::find(lens_parameter_names, parameter.name);
        if (!parameter.refined || name == lens_parameter_names.end()) continue;
        const auto i = name - lens_parameter_names.begin();
        const bool pixels = i < 4;
        changes.push_back(
            pixels ? fmt::format("{} {:.2f} -> {:.2f} ± {:.2f} px", *name, before[i], after[i], parameter.sigma)
                   : fmt::format("{} {:.4f} -> {:.4f} ± {:.4f}", *name, before[i], after[i], parameter.sigma));
    }
    return fmt::format("{}", fmt::join(changes, ", "));
}

void take_path(const ClipContext& context, const GeometrySolution& geometry, Solve& solve, TrackSummary& summary) {
    for (const RigTag& tag : context.scene.tags.rig) {
        const auto place = geometry.rig.world_from_tag.find(tag.id);
        if (place != geometry.rig.world_from_tag.end()) solve.rig.push_back({tag.id, tag.size_m, place->second});
    }
    std::int64_t small = 0, grazing = 0, cut_off = 0, disagreeing = 0, twice = 0, outvoted = 0, measured = 0;
    for (const PathFrame& frame : geometry.path.frames) {
        SolvedFrame& solved = solve.frames.emplace_back();
        solved.frame = frame.frame;
        solved.time_s = frame.time_s;
        solved.tags = frame.tags;
        twice += frame.seen_twice;
        outvoted += frame.outvoted;
        for (const int id : frame.tags) ++summary.frames_by_tag[id];
        if (!frame.pose) continue;
        solved.camera_from_world = frame.pose->camera_from_world;
        solved.covariance = frame.pose->covariance;
        solved.pose_confidence = frame.confidence;
        ++summary.posed;
        solved.bridged = frame.bridged;
        if (frame.bridged) continue;
        solved.reprojection_px = frame.reprojection_px;
        ++measured;
        summary.mean_reprojection_px += frame.reprojection_px;
        summary.worst_reprojection_px = std::max(summary.worst_reprojection_px, frame.reprojection_px);
        small += frame.small;
        grazing += frame.grazing;
        cut_off += frame.cut_off;
        disagreeing += frame.disagreeing;
    }
    summary.frames = static_cast<std::int64_t>(geometry.path.frames.size());
    summary.bridged = geometry.path.bridged;
    summary.missing = geometry.path.missing;
    if (measured > 0) summary.mean_reprojection_px /= static_cast<double>(measured);
    context.warn("frames without a tag were bridged from their neighbours", geometry.path.bridged);
    context.warn("frames without a tag have no pose: objects are left out there", geometry.path.missing);
    context.warn("frames show no tag of 25 px or more: the pose is uncertain", small);
    context.warn("frames show tags only under 15 degrees from the side: the pose is uncertain", grazing);
    context.warn("frames show only tags that the frame cuts off: the pose is uncertain", cut_off);
    context.warn("frames have tags that disagree by more than 2 px: one was moved, or the lens or a size is wrong",
                 disagreeing);
    context.warn("frames have a tag that the others outvote: it was moved, or smeared by motion", outvoted);
    context.warn("frames show an id twice: the one that fits the others was kept", twice);
}

std::optional<double> median(std::vector<double> values) {
    if (values.empty()) return std::nullopt;
    return upper_median_in_place(values);
}

void report_readout(const ClipContext& context, const GeometrySolution& geometry, Solve& solve, TrackSummary& summary) {
    const FootageSettings& footage = context.scene.footage;
    if (footage.readout_s > 0) solve.readout_s = footage.readout_s;
    if (!footage.solve_readout) return;
    solve.readout_s = geometry.readout_s;
    const double sigma_ms = 1000 * geometry.readout_sigma_s.value_or(0);
    if (geometry.readout_s) {
        summary.notes.push_back(fmt::format("rolling shutter: {:.1f} ± {:.1f} ms from the first row to the last",
                                            1000 * *geometry.readout_s, sigma_ms));
    } else {
        context.warn(
            fmt::format("the camera moves too little to tell its read-out time (± {:.0f} ms): taken as a global "
                        "shutter",
                        sigma_ms));
    }
}

/// Relative standard deviation of the focal length, where the clip found it.
std::optional<double> focal_sigma(const GeometrySolution& geometry) {
    const auto fx = std::ranges::find(geometry.lens_parameters, "fx", &LensParameter::name);
    if (fx == geometry.lens_parameters.end()) return std::nullopt;
    return fx->sigma / geometry.camera.fx;
}

void solve_through(const ClipContext& context, const std::vector<FrameObservations>& frames,
                   GeometrySolution& geometry) {
    geometry.rig = solve_rig(context.scene.tags.rig, frames);
    geometry.path = solve_path(context.scene.tags.rig, geometry.rig.world_from_tag, frames, geometry.camera);
    const bool needed = context.scene.footage.camera.empty() || context.scene.footage.solve_readout;
    if (needed || context.options.level != TrackLevel::fast) refine_geometry(context, frames, geometry);
}

}  // namespace

GeometrySolution solve_geometry(const ClipContext& context, const ClipObservations& clip) {
    GeometrySolution geometry;
    geometry.camera = context.camera;
    if (!context.scene.footage.camera.empty()) {
        solve_through(context, clip.frames, geometry);
        return geometry;
    }
    std::vector<FrameObservations> frames = clip.frames;
    const Camera guess = guessed_camera(context.camera.width, context.camera.height);
    if (context.camera.fx == guess.fx && context.camera.cx == guess.cx) {
        geometry.camera = find_lens(context.scene.tags.rig, frames, context.camera);
    }
    Camera seen_through = context.camera;
    constexpr int rounds = 2;  // which pose of a tag is the true one is asked again with the better lens
    for (int round = 0; round < rounds; ++round) {
        express_with(geometry.camera, seen_through, frames);
        seen_through = geometry.camera;
        solve_through(context, frames, geometry);
    }
    constexpr double most = 0.1;  // objects would stand at the wrong distance by as much
    const std::optional<double> sigma = focal_sigma(geometry);
    if (!sigma || !(*sigma < most)) {
        throw InputError(context.scene.footage.video,
                         fmt::format("the tags do not tell the focal length{}",
                                     sigma ? fmt::format(" (± {:.0f} %)", std::min(999.0, 100 * *sigma)) : ""),
                         "give [footage] camera, or film the tags aslant and from several distances");
    }
    return geometry;
}

void report_geometry(const ClipContext& context, const GeometrySolution& geometry, Solve& solve,
                     TrackSummary& summary) {
    warn_of_rig(context, geometry.rig);
    solve.camera = geometry.camera;
    solve.lens_parameters = geometry.lens_parameters;
    if (const std::string changes = refined_lens(context, geometry); !changes.empty()) {
        summary.notes.push_back("the lens as the clip shows it: " + changes);
    }
    constexpr double doubtful = 0.02;
    if (const auto sigma = focal_sigma(geometry); context.scene.footage.camera.empty() && sigma && *sigma > doubtful) {
        context.warn(
            fmt::format("the tags tell the focal length to {:.1f} % only: film them aslant and from several "
                        "distances, or give [footage] camera",
                        100 * *sigma));
    }
    report_readout(context, geometry, solve, summary);
    summary.leave_one_out_px = median(geometry.leave_one_out_px);
    take_path(context, geometry, solve, summary);
}

}  // namespace matchlight
