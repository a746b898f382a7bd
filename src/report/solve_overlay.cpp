// Lines through the lens: each is cut into pieces that the distortion bends.
#include "report/solve_overlay.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/base64.h"

namespace matchlight {
namespace {

constexpr int most_width_px = 960;
// Blue first, as OpenCV has it.
const cv::Scalar yellow(40, 220, 255), cyan(255, 230, 60), red(60, 60, 255), green(70, 210, 70), blue(255, 110, 60);

class Overlay {
public:
    Overlay(const Image8& picture, const Camera& camera) : camera_(camera) {
        const cv::Mat rgb(picture.height(), picture.width(), CV_8UC3,
                          const_cast<std::uint8_t*>(picture.samples().data()));
        scale_ = std::min(1.0, static_cast<double>(most_width_px) / picture.width());
        cv::resize(rgb, drawn_, {}, scale_, scale_, scale_ < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
        cv::cvtColor(drawn_, drawn_, cv::COLOR_RGB2BGR);
    }

    /// Of the plate, in the drawing's own fixed-point pixels.
    cv::Point at(const Eigen::Vector2d& px) const {
        const Eigen::Vector2d scaled = (px + Eigen::Vector2d(0.5, 0.5)) * scale_ - Eigen::Vector2d(0.5, 0.5);
        // Far outside nothing is seen, and the fixed-point numbers would overflow.
        constexpr double far_px = 20000;
        return {static_cast<int>(std::lround(std::clamp(scaled.x(), -far_px, far_px) * fixed_point)),
                static_cast<int>(std::lround(std::clamp(scaled.y(), -far_px, far_px) * fixed_point))};
    }

    void line_px(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const cv::Scalar& color, int width) {
        if (from.allFinite() && to.allFinite()) cv::line(drawn_, at(from), at(to), color, width, cv::LINE_AA, shift);
    }

    void line_world(const RigidTransform& camera_from_world, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                    const cv::Scalar& color, int width) {
        constexpr int pieces = 12;
        // The lens model holds for the picture; a little more than its diagonal is all that can be seen.
        const double reach = 2 * std::hypot(camera_.width, camera_.height);
        Eigen::Vector2d before = Eigen::Vector2d::Constant(std::nan(""));
        for (int i = 0; i <= pieces; ++i) {
            const Eigen::Vector3d seen = camera_from_world * (from + (to - from) * (static_cast<double>(i) / pieces));
            Eigen::Vector2d px = Eigen::Vector2d::Constant(std::nan(""));
            if (seen.z() > 0) px = camera_.pixel_from_camera(seen);
            if (before.allFinite() && px.allFinite() && (px - before).norm() < reach) {
                line_px(before, px, color, width);
            }
            before = px;
        }
    }

    void text(const Eigen::Vector2d& px, const std::string& what, const cv::Scalar& color) {
        cv::Point place = at(px);
        place.x /= fixed_point;
        place.y /= fixed_point;
        constexpr double size = 0.5;
        cv::putText(drawn_, what, place, cv::FONT_HERSHEY_SIMPLEX, size, cv::Scalar(0, 0, 0), 3, cv::LINE_AA);
        cv::putText(drawn_, what, place, cv::FONT_HERSHEY_SIMPLEX, size, color, 1, cv::LINE_AA);
    }

    std::string jpeg_url() const {
        std::vector<std::uint8_t> bytes;
        if (!cv::imencode(".jpg", drawn_, bytes, {cv::IMWRITE_JPEG_QUALITY, 85})) {
            throw std::runtime_error("a picture of the page cannot be encoded");
        }
        return "data:image/jpeg;base64," + base64(bytes);
    }

    double px_of_drawing() const { return 1 / scale_; }

private:
    static constexpr int shift = 4;  // bits of fraction in OpenCV's coordinates
    static constexpr int fixed_point = 1 << shift;
    const Camera& camera_;
    cv::Mat drawn_;
    double scale_ = 1;
};

void draw_rig(Overlay& overlay, const Solve& solve, const RigidTransform& camera_from_world) {
    double longest_m = 0;
    for (const SolvedTag& tag : solve.rig) {
        longest_m = std::max(longest_m, tag.size_m);
        const Eigen::Matrix<double, 3, 4> corners = tag.world_from_tag * tag_corners_m(tag.size_m);
        for (int i = 0; i < 4; ++i) {
            overlay.line_world(camera_from_world, corners.col(i), corners.col((i + 1) % 4), yellow, 1);
        }
        const Eigen::Vector3d seen = camera_from_world * Eigen::Vector3d(corners.col(3));
        if (seen.z() > 0) {
            overlay.text(solve.camera.pixel_from_camera(seen) + Eigen::Vector2d(0, -5 * overlay.px_of_drawing()),
                         fmt::format("{}", tag.id), yellow);
        }
    }
    const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    overlay.line_world(camera_from_world, origin, longest_m * Eigen::Vector3d::UnitX(), red, 2);
    overlay.line_world(camera_from_world, origin, longest_m * Eigen::Vector3d::UnitY(), green, 2);
    overlay.line_world(camera_from_world, origin, longest_m * Eigen::Vector3d::UnitZ(), blue, 2);
}

void draw_found(Overlay& overlay, const FrameResiduals& findings, bool posed) {
    const double arm = 4 * overlay.px_of_drawing();
    for (const TagResidual& tag : findings.tags) {
        for (int i = 0; i < 4; ++i) {
            const Eigen::Vector2d found = tag.observed_px.col(i);
            if (posed) {
                overlay.line_px(found, found + overlay_magnification * tag.residual_px.col(i), red, 2);
            }
            overlay.line_px(found - Eigen::Vector2d(arm, 0), found + Eigen::Vector2d(arm, 0), cyan, 1);
            overlay.line_px(found - Eigen::Vector2d(0, arm), found + Eigen::Vector2d(0, arm), cyan, 1);
        }
    }
}

}  // namespace

std::string solve_overlay_url(const Image8& picture, const Solve& solve, const SolvedFrame& frame,
                              const FrameResiduals& findings) {
    Overlay overlay(picture, solve.camera);
    if (frame.camera_from_world) draw_rig(overlay, solve, *frame.camera_from_world);
    draw_found(overlay, findings, frame.camera_from_world.has_value());
    return overlay.jpeg_url();
}

}  // namespace matchlight
