// Observations of tags as an ideal fit would give them, with noise of known size.
#pragma once

#include <random>
#include <vector>

#include "synthetic_view.h"
#include "tracking/tag_fit.h"

namespace matchlight::test {

struct PlacedTag {
    int id = 0;
    double size_m = 0.08;
    RigidTransform world_from_tag = RigidTransform::Identity();
};

/// Corners exactly where the lens puts them; a covariance of 1e-4 px², below which nothing depends on it.
inline TagObservation seen_tag(const Camera& camera, const RigidTransform& camera_from_world, const PlacedTag& tag) {
    TagObservation seen;
    seen.id = tag.id;
    const Eigen::Matrix<double, 3, 4> points = camera_from_world * (tag.world_from_tag * tag_corners_m(tag.size_m));
    double side = 0;
    for (int i = 0; i < 4; ++i) {
        seen.corners_normalized.col(i) = points.col(i).head<2>() / points(2, i);
        seen.corners_px.col(i) = camera.pixel_from_normalized(seen.corners_normalized.col(i));
    }
    for (int i = 0; i < 4; ++i) {
        side += (seen.corners_normalized.col(i) - seen.corners_normalized.col((i + 1) % 4)).norm() / 4;
    }
    seen.side_px = side * camera.fx;
    seen.covariance = TagCovariance::Identity() * (1e-4 / (camera.fx * camera.fx));
    seen.correlation = 0.99;
    seen.contrast = 0.7;
    seen.decision_margin = 60;
    seen.refined = true;
    return seen;
}

/// The same with independent noise on each coordinate, which its covariance states.
inline TagObservation noisy(TagObservation seen, const Camera& camera, double sigma_px, std::mt19937& random) {
    std::normal_distribution<double> noise(0, sigma_px);
    for (int i = 0; i < 4; ++i) {
        seen.corners_normalized.col(i) += Eigen::Vector2d(noise(random), noise(random)) / camera.fx;
        seen.corners_px.col(i) = camera.pixel_from_normalized(seen.corners_normalized.col(i));
    }
    seen.covariance = TagCovariance::Identity() * (sigma_px * sigma_px / (camera.fx * camera.fx));
    return seen;
}

/// Tags on a table, one of them on a slope.
inline std::vector<PlacedTag> four_tags() {
    std::vector<PlacedTag> rig(4);
    const Eigen::Vector3d places[] = {{0, 0, 0}, {-0.14, 0.01, 0}, {0.13, 0.03, 0.01}, {0.02, 0.14, 0.02}};
    const Eigen::Vector3d turns_deg[] = {{0, 0, 0}, {0, 0, 90}, {0, 0, 10}, {20, 0, -30}};
    for (int i = 0; i < 4; ++i) {
        PlacedTag& tag = rig[static_cast<std::size_t>(i)];
        tag.id = i;
        tag.size_m = i == 3 ? 0.06 : 0.08;
        tag.world_from_tag.linear() = rotation_from_degrees(turns_deg[i]);
        tag.world_from_tag.translation() = places[i];
    }
    return rig;
}

}  // namespace matchlight::test
