// Frames from one decoder, a detector a core.
#include "report/track_peers.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <thread>

#include "core/error.h"
#include "core/parallel.h"
#include "core/stop.h"
#include "media/frame_source.h"
#include "report/pose_peers.h"
#include "report/tag_agreement.h"
#include "scene/footage_options.h"
#include "tracking/plate_light.h"
#include "tracking/tag_detector.h"

namespace matchlight {

namespace {

/// A detection as an observation: corners only.
std::optional<TagObservation> observed(const TagDetection& detection, const Camera& camera) {
    const auto corners = normalized_corners(detection, camera);
    if (!corners) return std::nullopt;
    TagObservation seen;
    seen.id = detection.id;
    seen.corners_normalized = *corners;
    seen.covariance = TagCovariance::Identity() / (camera.fx * camera.fx);  // the library states none: a pixel
    for (int i = 0; i < 4; ++i) {
        seen.corners_px.col(i) = detection.corners_px[static_cast<std::size_t>(i)];
        seen.side_px += camera.fx * (corners->col(i) - corners->col((i + 1) % 4)).norm() / 4;
    }
    seen.decision_margin = detection.decision_margin;
    return seen;
}

}  // namespace

std::optional<RigidTransform> apriltag_pose_of_largest(const std::vector<PlacedObservation>& tags) {
    if (tags.empty()) return std::nullopt;
    const PlacedObservation& largest =
        *std::ranges::max_element(tags, {}, [](const PlacedObservation& tag) { return tag.seen->side_px; });
    return apriltag_pose(largest.seen->corners_normalized, largest.size_m) * largest.world_from_tag.inverse();
}

std::optional<RigidTransform> solve_pnp_pose_of(const std::vector<PlacedObservation>& tags) {
    std::vector<SeenPoint> points;
    for (const PlacedObservation& tag : tags) {
        const Eigen::Matrix<double, 3, 4> world = tag.world_from_tag * tag_corners_m(tag.size_m);
        for (int i = 0; i < 4; ++i) points.push_back({world.col(i), tag.seen->corners_normalized.col(i)});
    }
    return solve_pnp_pose(points);
}

PeerPoses track_with_peers(const Scene& scene, const Camera& camera, const std::vector<SolvedTag>& rig,
                           PeerPixels pixels, Warnings& warnings) {
    const auto source = FrameSource::open(scene.footage.video, footage_options(scene.footage, false), warnings);
    const PlateLight plate_light(footage_response(scene.footage), source->info().format.transfer);
    std::mutex source_mutex, result_mutex;
    bool ended = false;
    const auto next = [&]() -> std::optional<PlateFrame> {
        const std::lock_guard lock(source_mutex);
        if (ended) return std::nullopt;
        ended = true;  // also when decoding throws: the other workers stop
        if (stop_requested()) throw InputError(scene.footage.video, "stopped on request");
        std::optional<PlateFrame> frame = source->next();
        ended = !frame;
        return frame;
    };
    PeerPoses poses;
    parallel_for(static_cast<int>(std::max(1u, std::thread::hardware_concurrency())), [&](int) {
        const TagDetector detector(scene.tags.family, {.decimation = 1});
        while (const std::optional<PlateFrame> frame = next()) {
            const Region whole{0, 0, frame->format().width, frame->format().height};
            Image8 picture;
            if (pixels == PeerPixels::light) {
                picture = detection_image(plate_light.gray(*frame, whole));
            } else {
                const ImageF codes = frame->gray_code(whole);
                picture = Image8(codes.width(), codes.height(), 1);
                std::ranges::transform(codes.samples(), picture.samples().begin(), [](float code) {
                    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(code, 0.0f, 1.0f)));
                });
            }
            FrameObservations seen{frame->index(), frame->time_s(), {}};
            for (const TagDetection& detection : detector.detect(picture)) {
                if (const auto tag = observed(detection, camera)) seen.tags.push_back(*tag);
            }
            const std::lock_guard lock(result_mutex);
            poses.frames.push_back(std::move(seen));
        }
    });
    std::ranges::sort(poses.frames, {}, &FrameObservations::frame);
    for (const FrameObservations& frame : poses.frames) {
        const std::vector<PlacedObservation> tags = placed(frame, rig);
        SolvedFrame pose;
        pose.frame = frame.frame;
        pose.time_s = frame.time_s;
        pose.camera_from_world = apriltag_pose_of_largest(tags);
        poses.one_tag.push_back(pose);
        pose.camera_from_world = solve_pnp_pose_of(tags);
        poses.all_tags.push_back(pose);
    }
    return poses;
}

}  // namespace matchlight
