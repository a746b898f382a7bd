// The reference renderer, with what tests add to its light.
#include "synthetic_view.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/transfer.h"
#include "report/tag_view_reference.h"

namespace matchlight::test {

ImageF render_light(const SyntheticView& view, const std::vector<SyntheticTag>& tags) {
    TagView reference;
    reference.camera = view.camera;
    reference.camera_from_world = [&view](double) { return view.camera_from_world; };
    reference.ground = view.ground;
    for (const SyntheticTag& tag : tags) {
        reference.tags.push_back({.pattern = tag.pattern,
                                  .id = tag.id,
                                  .size_m = tag.size_m,
                                  .world_from_tag = tag.world_from_tag,
                                  .paper = view.paper,
                                  .ink = view.ink});
    }
    ImageF light = reference_light(reference);
    cv::Mat picture(light.height(), light.width(), CV_32F, light.samples().data());
    if (!view.motion_px.empty()) {
        cv::Mat moved = cv::Mat::zeros(picture.size(), CV_32F), shifted;
        for (const auto& [offset, weight] : view.motion_px) {
            const cv::Matx23d shift(1, 0, offset.x(), 0, 1, offset.y());
            cv::warpAffine(picture, shifted, shift, picture.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
            moved += weight * shifted;
        }
        moved.copyTo(picture);
    }
    if (view.blur_px > 0) cv::GaussianBlur(picture, picture, cv::Size(), view.blur_px);
    if (view.noise_codes > 0) {
        std::mt19937 random(view.seed);
        std::normal_distribution<double> noise(0, view.noise_codes);
        for (float& sample : light.samples()) {
            const double code = 255 * srgb_code_from_linear(sample) + noise(random);
            sample = static_cast<float>(linear_from_srgb_code(std::clamp(std::round(code), 0.0, 255.0) / 255));
        }
    }
    return light;
}

Eigen::Matrix<double, 2, 4> true_corners_px(const SyntheticView& view, const SyntheticTag& tag) {
    const Eigen::Matrix<double, 3, 4> points =
        view.camera_from_world * (tag.world_from_tag * tag_corners_m(tag.size_m));
    Eigen::Matrix<double, 2, 4> corners;
    for (int i = 0; i < 4; ++i) corners.col(i) = view.camera.pixel_from_camera(points.col(i));
    return corners;
}

TagDetection rough_detection(const SyntheticView& view, const SyntheticTag& tag, double error_px) {
    const Eigen::Matrix<double, 2, 4> corners = true_corners_px(view, tag);
    TagDetection detection;
    detection.id = tag.id;
    detection.decision_margin = 50;
    for (int i = 0; i < 4; ++i) {
        const double angle = 1 + 2.4 * i;
        detection.corners_px[static_cast<std::size_t>(i)] =
            corners.col(i) + error_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
    return detection;
}

Camera ordinary_camera() {
    Camera camera;
    camera.width = 640, camera.height = 360;
    camera.fx = 620, camera.fy = 623, camera.cx = 321.3, camera.cy = 178.6;
    camera.distortion = {-0.12, 0.05, 0.0006, -0.0004, 0.01};
    return camera;
}

RigidTransform orbit_pose(double distance_m, double tilt_deg, double turn_deg, double roll_deg) {
    // Straight above, the camera's x runs along the world's and its y against the world's.
    RigidTransform above = RigidTransform::Identity();
    above.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
    above.translation() = Eigen::Vector3d(0, 0, distance_m);
    RigidTransform turned = RigidTransform::Identity();
    turned.linear() = rotation_from_degrees({tilt_deg, 0, 0}) * rotation_from_degrees({0, 0, turn_deg});
    RigidTransform rolled = RigidTransform::Identity();
    rolled.linear() = rotation_from_degrees({0, 0, roll_deg});
    return rolled * above * turned;
}

}  // namespace matchlight::test
