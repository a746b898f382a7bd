// Pictures of tags with exactly known poses: area-sampled through a camera with its distortion, blurred, noisy.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "calibration/camera.h"
#include "calibration/tag_family.h"
#include "core/image.h"
#include "core/transforms.h"
#include "tracking/tag_detector.h"

namespace matchlight::test {

struct SyntheticTag {
    TagPattern pattern;
    int id = 0;
    double size_m = 0.08;
    RigidTransform world_from_tag = RigidTransform::Identity();
};

struct SyntheticView {
    Camera camera;
    RigidTransform camera_from_world = RigidTransform::Identity();
    double paper = 0.8, ink = 0.05, ground = 0.3;  // linear light
    double blur_px = 0;                            // Gaussian
    double noise_codes = 0;                        // of 255, sRGB-coded, then rounded to 8 bit; 0 leaves floats
    /// Weighted displacements (px) of the picture during the exposure.
    std::vector<std::pair<Eigen::Vector2d, double>> motion_px;
    unsigned seed = 1;
};

/// Linear light, one channel.
ImageF render_light(const SyntheticView& view, const std::vector<SyntheticTag>& tags);

/// True corners, in tag_corners_m's order.
Eigen::Matrix<double, 2, 4> true_corners_px(const SyntheticView& view, const SyntheticTag& tag);

/// A detection at the true corners, displaced by `error_px` in different directions.
TagDetection rough_detection(const SyntheticView& view, const SyntheticTag& tag, double error_px);

/// A camera of 640 × 360 with the distortion of an ordinary lens.
Camera ordinary_camera();

/// A camera `distance_m` from the origin of the world, tilted from straight above by `tilt_deg`, turned about the
/// world's z by `turn_deg`, looking at the origin with its image rolled by `roll_deg`.
RigidTransform orbit_pose(double distance_m, double tilt_deg, double turn_deg, double roll_deg);

}  // namespace matchlight::test
