// Rig and path one after the other, and what is said of them.
#include "tracking/geometry_stage.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

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

}  // namespace

GeometrySolution solve_geometry(const ClipContext& context, const ClipObservations& clip) {
    GeometrySolution geometry;
    geometry.camera = context.camera;
    geometry.rig = solve_rig(context.scene.tags.rig, clip.frames);
    geometry.path = solve_path(context.scene.tags.rig, geometry.rig.world_from_tag, clip.frames, geometry.camera);
    return geometry;
}

void report_geometry(const ClipContext& context, const GeometrySolution& geometry, Solve& solve,
                     TrackSummary& summary) {
    warn_of_rig(context, geometry.rig);
    solve.camera = geometry.camera;
    take_path(context, geometry, solve, summary);
}

}  // namespace matchlight
