// Ray casting of flat tags.
#include "synthetic_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/transfer.h"

namespace matchlight::test {

namespace {

/// Light of the tag's sheet at grid coordinates, or NaN outside it. The sheet has a margin of one cell around the grid.
double sheet_light(const SyntheticView& view, const TagPattern& pattern, double a, double b) {
    if (a < -1 || b < -1 || a >= pattern.cells + 1 || b >= pattern.cells + 1) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    const int x = static_cast<int>(std::floor(a)), y = static_cast<int>(std::floor(b));
    const bool inside = x >= 0 && y >= 0 && x < pattern.cells && y < pattern.cells;
    return inside && pattern.at(x, y) == TagPattern::black ? view.ink : view.paper;
}

/// The view's tags with what does not change from pixel to pixel.
class TagScene {
public:
    TagScene(const SyntheticView& view, const std::vector<SyntheticTag>& tags) : view_(view) {
        for (const SyntheticTag& tag : tags) {
            const Eigen::Matrix<double, 2, 4> corners = true_corners_px(view, tag);
            const Eigen::Vector2d low = corners.rowwise().minCoeff(), high = corners.rowwise().maxCoeff();
            const Eigen::Vector2d margin = 0.5 * (high - low) + Eigen::Vector2d(4, 4);
            entries_.push_back(
                {&tag, (view.camera_from_world * tag.world_from_tag).inverse(), low - margin, high + margin});
        }
    }

    bool near_tag(double x, double y) const {
        return std::ranges::any_of(entries_, [&](const Entry& entry) {
            return x > entry.low.x() && y > entry.low.y() && x < entry.high.x() && y < entry.high.y();
        });
    }

    double light_at(const Eigen::Vector2d& px) const {
        const Eigen::Vector3d ray = view_.camera.normalized_from_pixel(px).homogeneous();
        for (const Entry& entry : entries_) {
            const Eigen::Vector3d from = entry.tag_from_camera.translation();
            const Eigen::Vector3d direction = entry.tag_from_camera.linear() * ray;
            if (!(direction.z() < 0)) continue;  // seen from behind
            const Eigen::Vector3d hit = from - from.z() / direction.z() * direction;
            const TagPattern& pattern = entry.tag->pattern;
            const double cell_m = entry.tag->size_m / (pattern.border_end - pattern.border_begin);
            const double middle = pattern.cells / 2.0;
            const double light = sheet_light(view_, pattern, middle + hit.x() / cell_m, middle - hit.y() / cell_m);
            if (!std::isnan(light)) return light;
        }
        return view_.ground;
    }

private:
    struct Entry {
        const SyntheticTag* tag;
        RigidTransform tag_from_camera;
        Eigen::Vector2d low, high;
    };
    const SyntheticView& view_;
    std::vector<Entry> entries_;
};

/// Mean light of a pixel; one whose corners and middle agree is taken as even (cells are several pixels wide).
double pixel_light(const TagScene& scene, int x, int y, int samples) {
    const double middle = scene.light_at(Eigen::Vector2d(x, y));
    bool even = true;
    for (const double dy : {-0.5, 0.5}) {
        for (const double dx : {-0.5, 0.5}) even = even && scene.light_at(Eigen::Vector2d(x + dx, y + dy)) == middle;
    }
    if (even) return middle;
    double sum = 0;
    for (int j = 0; j < samples; ++j) {
        for (int i = 0; i < samples; ++i) {
            sum += scene.light_at({x - 0.5 + (i + 0.5) / samples, y - 0.5 + (j + 0.5) / samples});
        }
    }
    return sum / (samples * samples);
}

}  // namespace

ImageF render_light(const SyntheticView& view, const std::vector<SyntheticTag>& tags) {
    const Camera& camera = view.camera;
    const TagScene scene(view, tags);
    ImageF light(camera.width, camera.height, 1, static_cast<float>(view.ground));
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
            if (scene.near_tag(x, y)) light.at(x, y) = static_cast<float>(pixel_light(scene, x, y, view.samples));
        }
    }
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
