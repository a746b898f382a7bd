// Whole clips of observed tags with everything known: path, lens, shutter, places.
#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "core/warnings.h"
#include "synthetic_observations.h"
#include "tracking/geometry_stage.h"

namespace matchlight::test {

struct SyntheticClip {
    Camera camera = ordinary_camera();
    std::vector<PlacedTag> tags;
    std::function<RigidTransform(double)> camera_from_world;  // of the time in seconds
    int frames = 60;
    double frame_s = 1 / 24.0;
    double noise_px = 0.03;  // independent
    double bias_px = 0;      // of each corner on its sheet, the same in all frames, at the first one's distance
    double readout_s = 0;
    unsigned seed = 1;

    ClipObservations observe() const {
        std::mt19937 random(seed);
        std::normal_distribution<double> normal;
        std::vector<Eigen::Matrix<double, 3, 4>> offsets_m;
        for (const PlacedTag& tag : tags) {
            const double metres_per_px = tag.size_m / seen_tag(camera, camera_from_world(0), tag).side_px;
            Eigen::Matrix<double, 3, 4>& offsets = offsets_m.emplace_back();
            offsets.setZero();
            for (int c = 0; c < 4; ++c) {
                for (int axis = 0; axis < 2; ++axis) offsets(axis, c) = bias_px * metres_per_px * normal(random);
            }
        }
        ClipObservations clip;
        for (int f = 0; f < frames; ++f) {
            FrameObservations& frame = clip.frames.emplace_back();
            frame.frame = f;
            frame.time_s = f * frame_s;
            for (std::size_t i = 0; i < tags.size(); ++i) {
                TagObservation seen = seen_tag(camera, camera_from_world(frame.time_s), tags[i]);
                project(frame.time_s, tags[i], offsets_m[i], seen);
                for (int c = 0; c < 4; ++c) {
                    seen.corners_px.col(c) += noise_px * Eigen::Vector2d(normal(random), normal(random));
                    seen.corners_normalized.col(c) = camera.normalized_from_pixel(seen.corners_px.col(c));
                }
                seen.covariance = TagCovariance::Identity() * std::pow(noise_px / camera.fx, 2);
                frame.tags.push_back(seen);
            }
            clip.cards.emplace_back();
        }
        return clip;
    }

    /// Solves it through `calibrated`, or without a calibration.
    GeometrySolution solve(const ClipObservations& clip, const std::vector<int>& given, Scene scene = {},
                           const std::optional<Camera>& calibrated = std::nullopt) const {
        for (const PlacedTag& tag : tags) {
            RigTag& wanted = scene.tags.rig.emplace_back();
            wanted.id = tag.id;
            wanted.size_m = tag.size_m;
            if (std::ranges::find(given, tag.id) != given.end()) wanted.world_from_tag = tag.world_from_tag;
        }
        const Response response = Response::srgb();
        const std::optional<Probe> probe;
        const FootageInfo footage;
        Warnings warnings;
        const TrackOptions options;
        const Camera through = calibrated.value_or(camera);
        const ClipContext context{scene, options, footage, through, response, probe, warnings};
        return solve_geometry(context, clip);
    }

private:
    /// Each corner is seen when its row is read.
    void project(double time_s, const PlacedTag& tag, const Eigen::Matrix<double, 3, 4>& offsets_m,
                 TagObservation& seen) const {
        const Eigen::Matrix<double, 3, 4> corners_m = tag.world_from_tag * (tag_corners_m(tag.size_m) + offsets_m);
        for (int pass = 0; pass < (readout_s > 0 ? 3 : 1); ++pass) {
            for (int c = 0; c < 4; ++c) {
                const double phase = seen.corners_px(1, c) / (camera.height - 1) - 0.5;
                const RigidTransform pose = camera_from_world(time_s + readout_s * phase);
                seen.corners_px.col(c) = camera.pixel_from_camera(pose * corners_m.col(c));
            }
        }
    }
};

/// Four sheets on a table, in different directions.
inline std::vector<PlacedTag> flat_tags() {
    std::vector<PlacedTag> tags = four_tags();
    for (PlacedTag& tag : tags) tag.world_from_tag.translation().z() = 0;
    tags[3].world_from_tag.linear() = rotation_from_degrees({0, 0, -30});
    return tags;
}

/// A camera that circles, comes closer and rolls, slowly.
inline RigidTransform wandering(double time_s) {
    return orbit_pose(0.62 + 0.1 * std::sin(0.9 * time_s), 42 + 12 * std::sin(1.3 * time_s),
                      40 * std::sin(0.7 * time_s), 12 * std::sin(1.1 * time_s));
}

/// Scene with `camera` given; its file is never read here.
inline Scene calibrated_scene(LensRefinement refinement = LensRefinement::automatic) {
    Scene scene;
    scene.footage.video = "clip.mp4";
    scene.footage.camera = "camera.yaml";
    scene.footage.refine_lens = refinement;
    return scene;
}

/// Mean distance (px) of points over the tags between two poses, through one camera.
inline double registration_px(const Camera& camera, const RigidTransform& a, const RigidTransform& b) {
    double sum = 0;
    int count = 0;
    for (const double x : {-0.08, 0.08}) {
        for (const double y : {-0.06, 0.08}) {
            for (const double z : {0.0, 0.08}) {
                const Eigen::Vector3d point(x, y, z);
                sum += (camera.pixel_from_camera(a * point) - camera.pixel_from_camera(b * point)).norm();
                ++count;
            }
        }
    }
    return sum / count;
}

}  // namespace matchlight::test
