// Motions between neighbouring exposures, and photographs resampled by them.
#include "calibration/merge_alignment.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace matchlight {
namespace {

/// A photograph's green light as the longer of two exposures would take it, rooted, so that noise is even over it.
struct Plane {
    cv::Mat value;  // 0..1
    cv::Mat known;  // 255 away from full light
};

Plane plane_of(const MergeSetup& setup, std::size_t shot, double ratio) {
    constexpr int green = 1;
    const float full = setup.weights[shot].full_light(green);
    Plane plane{cv::Mat(setup.height(), setup.width(), CV_32F), {}};
    for (int y = 0; y < setup.height(); ++y) {
        for (int x = 0; x < setup.width(); ++x) {
            const float code = setup.codes[shot]->at(x, y, green);
            const float light = setup.table.light(code, green) * static_cast<float>(ratio) / full;
            plane.value.at<float>(y, x) = std::sqrt(std::clamp(light, 0.0f, 1.0f));
        }
    }
    // By smoothed light: by each pixel's own, the ones that noise darkened would be kept.
    cv::Mat smooth;
    constexpr double smoothing_px = 1.5, most = 0.9;
    cv::GaussianBlur(plane.value, smooth, {}, smoothing_px);
    plane.known = smooth < most;
    return plane;
}

/// Of image coordinates, as OpenCV's warps take it: what the template shows at x stands in the input at M·(x, 1).
using Warp = cv::Matx23f;
const Warp no_motion(1, 0, 0, 0, 1, 0);

Warp scaled(const Warp& warp, double factor) {
    Warp result = warp;
    // Pixel centres lie at whole numbers: x' + ½ = f·(x + ½).
    const double shift = 0.5 * (factor - 1);
    for (int r = 0; r < 2; ++r) {
        const double rotated = warp(r, 0) * shift + warp(r, 1) * shift;
        result(r, 2) = static_cast<float>(factor * warp(r, 2) + shift - rotated);
    }
    return result;
}

double mean_square_difference(const Plane& fixed, const Plane& moving, const Warp& warp) {
    cv::Mat value, known, difference;
    const int flags = cv::INTER_LINEAR | cv::WARP_INVERSE_MAP;
    cv::warpAffine(moving.value, value, warp, fixed.value.size(), flags);
    cv::warpAffine(moving.known, known, warp, fixed.value.size(), cv::INTER_NEAREST | cv::WARP_INVERSE_MAP);
    cv::bitwise_and(known, fixed.known, known);
    cv::subtract(value, fixed.value, difference);
    return cv::mean(difference.mul(difference), known)[0];
}

Plane reduced(const Plane& plane, double factor) {
    Plane small;
    cv::resize(plane.value, small.value, {}, factor, factor, cv::INTER_AREA);
    cv::resize(plane.known, small.known, {}, factor, factor, cv::INTER_AREA);
    small.known = small.known == 255;
    return small;
}

/// Correlates best at a coarse scale; contrast on less than a hundredth of the picture tells nothing.
std::optional<Warp> coarse_motion(const Plane& fixed, const Plane& moving) {
    cv::Mat a = fixed.value.clone(), b = moving.value.clone(), both;
    cv::bitwise_and(fixed.known, moving.known, both);
    if (cv::countNonZero(both) < static_cast<int>(both.total() / 100)) return std::nullopt;
    // Unknown pixels are even: their edges would pull towards no motion.
    const cv::Scalar middle = cv::mean(fixed.value, both);
    a.setTo(middle, fixed.known == 0);
    b.setTo(middle, moving.known == 0);
    cv::Scalar mean, deviation;
    cv::meanStdDev(a, mean, deviation, both);
    if (deviation[0] < 1e-3) return std::nullopt;
    cv::Mat window;
    cv::createHanningWindow(window, a.size(), CV_32F);
    const cv::Point2d shift = cv::phaseCorrelate(a, b, window);
    Warp warp = no_motion;
    warp(0, 2) = static_cast<float>(shift.x);
    warp(1, 2) = static_cast<float>(shift.y);
    // A peak of noise is worse than none.
    return mean_square_difference(fixed, moving, warp) < mean_square_difference(fixed, moving, no_motion) ? warp
                                                                                                          : no_motion;
}

/// Of the moving against the fixed plane; nothing where their pictures do not tell.
std::optional<Warp> motion_between(const Plane& fixed, const Plane& moving) {
    constexpr double coarse_side = 256, fine_side = 1024;
    const double side = std::max(fixed.value.cols, fixed.value.rows);
    std::optional<Warp> warp;
    double scale = std::min(1.0, coarse_side / side);
    // A thousand pixels a side tell a motion to hundredths of a full-size pixel; larger pictures need not be searched.
    for (const double target : {std::min(1.0, coarse_side / side), std::min(1.0, fine_side / side)}) {
        const Plane small_fixed = reduced(fixed, target), small_moving = reduced(moving, target);
        warp = warp ? scaled(*warp, target / scale) : coarse_motion(small_fixed, small_moving);
        scale = target;
        if (!warp) return std::nullopt;
        // OpenCV masks the moving picture only: what is full in the fixed one is masked where it comes to lie.
        cv::Mat found(*warp), known;
        cv::warpAffine(small_fixed.known, known, *warp, small_fixed.known.size(), cv::INTER_NEAREST);
        cv::bitwise_and(known, small_moving.known, known);
        cv::erode(known, known, cv::Mat::ones(3, 3, CV_8U));
        try {
            const cv::TermCriteria until(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 50, 1e-6);
            constexpr int smoothing_px = 3;
            const double correlation = cv::findTransformECC(small_fixed.value, small_moving.value, found,
                                                            cv::MOTION_EUCLIDEAN, until, known, smoothing_px);
            // Less than half in common: what they share is not seen, and the maximum may be noise's.
            constexpr double least_correlation = 0.5;
            if (correlation < least_correlation) return std::nullopt;
        } catch (const cv::Exception&) {
            return std::nullopt;  // the pictures do not correlate
        }
        *warp = Warp(found);
    }
    return scaled(*warp, 1 / scale);
}

cv::Matx33d squared(const Warp& warp) {
    return {warp(0, 0), warp(0, 1), warp(0, 2), warp(1, 0), warp(1, 1), warp(1, 2), 0, 0, 1};
}
Warp narrowed(const cv::Matx33d& warp) {
    return {static_cast<float>(warp(0, 0)), static_cast<float>(warp(0, 1)), static_cast<float>(warp(0, 2)),
            static_cast<float>(warp(1, 0)), static_cast<float>(warp(1, 1)), static_cast<float>(warp(1, 2))};
}

/// How far the corner that moves most moves.
double largest_shift_px(const Warp& warp, const cv::Size& size) {
    double largest = 0;
    for (const double x : {0.0, size.width - 1.0}) {
        for (const double y : {0.0, size.height - 1.0}) {
            const cv::Vec3d corner(x, y, 1);
            const cv::Vec3d moved = squared(warp) * corner;
            largest = std::max(largest, std::hypot(moved[0] - x, moved[1] - y));
        }
    }
    return largest;
}

/// A photograph is seen to have moved when moved it agrees by a twentieth better than when moved the opposite way, and
/// better than when moved a pixel further in any direction: along an even slope of light any motion is as good as
/// another step of exposure.
bool is_seen(const Plane& fixed, const Plane& moving, const Warp& warp) {
    // Less blurs more by resampling than it mends.
    constexpr double least_px = 0.15;
    if (largest_shift_px(warp, fixed.value.size()) < least_px) return false;
    const double moved = mean_square_difference(fixed, moving, warp);
    const Warp opposite = narrowed(squared(warp).inv());
    if (moved >= 0.95 * mean_square_difference(fixed, moving, opposite)) return false;
    for (const cv::Vec2f& further : {cv::Vec2f(1, 0), cv::Vec2f(-1, 0), cv::Vec2f(0, 1), cv::Vec2f(0, -1)}) {
        Warp other = warp;
        other(0, 2) += further[0];
        other(1, 2) += further[1];
        if (mean_square_difference(fixed, moving, other) < 1.02 * moved) return false;
    }
    return true;
}

PhotographMotion motion_of(const cv::Matx33d& warp, int width, int height) {
    const cv::Vec3d centre(0.5 * (width - 1), 0.5 * (height - 1), 1);
    const cv::Vec3d moved = warp * centre;
    return {moved[0] - centre[0], moved[1] - centre[1], std::atan2(warp(1, 0), warp(0, 0))};
}

}  // namespace

std::vector<std::optional<PhotographMotion>> find_motions(const MergeSetup& setup, std::size_t reference,
                                                          bool only_seen) {
    const std::size_t count = setup.codes.size();
    // Of each photograph against the one before it, the longer exposure.
    std::vector<cv::Matx33d> steps(count, cv::Matx33d::eye());
    for (std::size_t i = 0; i + 1 < count; ++i) {
        const Plane longer = plane_of(setup, i, 1);
        const Plane shorter = plane_of(setup, i + 1, setup.exposures[i] / setup.exposures[i + 1]);
        const std::optional<Warp> warp = motion_between(longer, shorter);
        if (warp && (!only_seen || is_seen(longer, shorter, *warp))) steps[i + 1] = squared(*warp);
    }
    std::vector<std::optional<PhotographMotion>> motions(count);
    cv::Matx33d shorter_from_reference = cv::Matx33d::eye(), longer_from_reference = cv::Matx33d::eye();
    const auto keep = [&](std::size_t i, const cv::Matx33d& from_reference) {
        if (from_reference != cv::Matx33d::eye()) motions[i] = motion_of(from_reference, setup.width(), setup.height());
    };
    for (std::size_t i = reference + 1; i < count; ++i) {
        shorter_from_reference = steps[i] * shorter_from_reference;
        keep(i, shorter_from_reference);
    }
    for (std::size_t i = reference; i > 0; --i) {
        longer_from_reference = steps[i].inv() * longer_from_reference;
        keep(i - 1, longer_from_reference);
    }
    return motions;
}

ImageF moved_codes(const ImageF& code, const PhotographMotion& motion, const CodeTable& table, const FullCodes& full) {
    const double cx = 0.5 * (code.width() - 1), cy = 0.5 * (code.height() - 1);
    const double c = std::cos(motion.angle_rad), s = std::sin(motion.angle_rad);
    const cv::Matx23d warp(c, -s, cx + motion.right_px - c * cx + s * cy, s, c, cy + motion.down_px - s * cx - c * cy);
    ImageF moved(code.width(), code.height(), 3);
    cv::Mat light(code.height(), code.width(), CV_32F), is_full(code.height(), code.width(), CV_32F), warped, mask;
    for (int channel = 0; channel < 3; ++channel) {
        const auto limit = static_cast<float>(full[static_cast<std::size_t>(channel)] - 0.5 * table.code_step());
        for (int y = 0; y < code.height(); ++y) {
            for (int x = 0; x < code.width(); ++x) {
                light.at<float>(y, x) = table.light(code.at(x, y, channel), channel);
                is_full.at<float>(y, x) = code.at(x, y, channel) > limit ? 1.0f : 0.0f;
            }
        }
        // Cubic interpolation reaches one pixel further than linear.
        cv::dilate(is_full, is_full, cv::Mat::ones(3, 3, CV_8U));
        cv::warpAffine(light, warped, warp, light.size(), cv::INTER_CUBIC | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
        cv::warpAffine(is_full, mask, warp, light.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT,
                       cv::Scalar(1));
        for (int y = 0; y < code.height(); ++y) {
            for (int x = 0; x < code.width(); ++x) {
                moved.at(x, y, channel) =
                    mask.at<float>(y, x) > 0 ? outside_code : table.code(warped.at<float>(y, x), channel);
            }
        }
    }
    return moved;
}

}  // namespace matchlight
