// Finds a ball in a photograph and its outline to a fraction of a pixel.
#include "lighting/ball_outline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/median.h"
#include "core/parallel.h"
#include "lighting/outline_fit.h"

namespace matchlight {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;
/// Of some two hundred circles proposed in clutter the best has a significance of 7 to 8.
constexpr double least_significance = 9;

/// Logarithms of light, in which an edge is as strong in the shade as in the sun.
cv::Mat log_light(const ImageF& radiance) {
    std::vector<double> values;
    for (std::size_t i = 0; i < radiance.samples().size(); i += 3 * 17) values.push_back(radiance.samples()[i + 1]);
    // Before black cloth the median is the cloth's: then the light of the brightest tenth counts.
    double middle = 1;
    if (!values.empty()) {
        const auto bright = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 9 / 10);
        std::ranges::nth_element(values, bright);
        const double bright_light = *bright;
        middle = std::max({upper_median(values), bright_light / 16, 1e-12});
    }
    // A twentieth of the middle is added, so that noise in the dark makes no edges, and beyond sixteen times the middle
    // one lamp is like another.
    const float lift = static_cast<float>(middle / 20), most = static_cast<float>(16 * middle);
    cv::Mat result(radiance.height(), radiance.width(), CV_32FC3);
    for (int y = 0; y < radiance.height(); ++y) {
        auto* row = result.ptr<float>(y);
        const auto from = radiance.row(y);
        for (std::size_t i = 0; i < from.size(); ++i) row[i] = std::log2(std::min(from[i], most) + lift);
    }
    return result;
}

BallOutline outline_from_circle(const Camera& camera, const OutlineCircle& circle) {
    // The mean of the rays opposite each other on the rim; exact enough to start from.
    BallOutline outline;
    const auto ray = [&](double x, double y) {
        return Eigen::Vector3d(camera.normalized_from_pixel({x, y}).homogeneous().normalized());
    };
    const Eigen::Vector2d c = circle.centre_px;
    const Eigen::Vector3d left = ray(c.x() - circle.radius_px, c.y()), right = ray(c.x() + circle.radius_px, c.y());
    outline.axis = (left + right).normalized();
    outline.half_angle = std::atan2(left.cross(right).norm(), left.dot(right)) / 2;
    return outline;
}

/// What is round within the ball is a reflection: of a horizon, of a lamp.
bool encloses(const BallOutline& outer, const BallOutline& inner) {
    const double between = std::acos(std::clamp(outer.axis.dot(inner.axis), -1.0, 1.0));
    return outer.half_angle > 1.02 * inner.half_angle && between + inner.half_angle < 1.1 * outer.half_angle;
}

std::vector<OutlineCircle> proposed_circles(const cv::Mat& light) {
    cv::Mat grey, small;
    cv::transform(light, grey, cv::Matx13f(1.F / 3, 1.F / 3, 1.F / 3));
    // Ball photographs are made to show the ball: 640 pixels are enough to propose it.
    const double scale = std::min(1.0, 640.0 / std::max(light.cols, light.rows));
    cv::resize(grey, small, {}, scale, scale, cv::INTER_AREA);
    const double side = std::min(small.cols, small.rows);
    std::vector<OutlineCircle> result;
    // As it is, and with the shadows, where noise makes edges too, held back.
    for (const bool shadows : {true, false}) {
        cv::Mat eight;
        if (!shadows) {
            const double middle = std::exp2(cv::mean(small)[0]);
            small.forEach<float>([middle](float& value, const int*) {
                value = static_cast<float>(std::log2(std::exp2(static_cast<double>(value)) + 2 * middle));
            });
        }
        double least = 0, most = 0;
        cv::minMaxLoc(small, &least, &most);
        // Ten stops about the middle hold every outline; a lamp beyond must not squeeze them.
        const double middle = cv::mean(small)[0];
        least = std::max(least, middle - 5), most = std::min(most, middle + 5);
        const double gain = 255 / std::max(most - least, 1e-6);
        small.convertTo(eight, CV_8U, gain, -least * gain);
        cv::GaussianBlur(eight, eight, {}, 1);
        // A range of radii at a time: the transform keeps one circle a centre, and the ball's own reflections have
        // others.
        for (double radius = std::min(8.0, side / 4); radius < 0.55 * side; radius *= 1.6) {
            std::vector<cv::Vec3f> circles;
            constexpr double strong_edge = 60, least_votes = 12;
            const int least_px = static_cast<int>(radius), most_px = static_cast<int>(std::ceil(radius * 1.7));
            cv::HoughCircles(eight, circles, cv::HOUGH_GRADIENT, 1.5, std::max(4.0, radius / 2), strong_edge,
                             least_votes, least_px, most_px);
            for (std::size_t i = 0; i < std::min<std::size_t>(circles.size(), 16); ++i) {
                // A pixel of the small picture stands for 1/scale of the large one's; centres at whole numbers.
                result.push_back({{(circles[i][0] + 0.5) / scale - 0.5, (circles[i][1] + 0.5) / scale - 0.5},
                                  circles[i][2] / scale});
            }
        }
    }
    return result;
}

/// The outline whose edges chance explains least, among those that the circles lead to; nullopt where none has edges.
std::optional<BallOutline> best_outline(const cv::Mat& light, const Camera& camera,
                                        const std::vector<OutlineCircle>& circles) {
    // Most proposals are clutter: only the better ones are worth refining.
    std::vector<std::optional<BallOutline>> settled(circles.size());
    parallel_for(static_cast<int>(circles.size()), [&](int i) {
        const BallOutline start = outline_from_circle(camera, circles[static_cast<std::size_t>(i)]);
        if (!(start.half_angle > 0)) return;
        OutlineFit fit(light, camera, start);
        if (fit.settle()) settled[static_cast<std::size_t>(i)] = fit.outline();
    });
    std::vector<BallOutline> outlines;
    for (const auto& outline : settled) {
        if (outline) outlines.push_back(*outline);
    }
    std::ranges::stable_sort(outlines, std::greater<>(), &BallOutline::significance);
    constexpr std::size_t refined = 24;
    outlines.resize(std::min(outlines.size(), refined));
    // A reflected horizon close inside the rim may draw the proposal to itself: the neighbourhood is looked at too.
    parallel_for(static_cast<int>(outlines.size()), [&](int i) {
        BallOutline& outline = outlines[static_cast<std::size_t>(i)];
        for (const double factor : {0.94, 1.03, 1.06, 1.1}) {
            BallOutline start = outline;
            start.half_angle *= factor;
            OutlineFit fit(light, camera, start);
            if (fit.settle() && fit.outline().significance > outline.significance) outline = fit.outline();
        }
    });
    std::erase_if(outlines, [&](BallOutline& outline) {
        OutlineFit fit(light, camera, outline);
        if (!fit.refine()) return true;
        outline = fit.outline();
        return false;
    });
    std::ranges::stable_sort(outlines, std::greater<>(), &BallOutline::significance);
    std::optional<BallOutline> best;
    for (const BallOutline& outline : outlines) {
        if (!best || (outline.significance > least_significance && encloses(outline, *best))) best = outline;
    }
    return best;
}

}  // namespace

Eigen::Vector2d BallOutline::pixel_at(const Camera& camera, double turn) const {
    return outline_pixel(camera, frame_about(axis), half_angle, turn);
}

double BallOutline::radius_px(const Camera& camera) const {
    const Eigen::Vector2d middle = camera.pixel_from_camera(axis);
    double sum = 0;
    constexpr int turns = 32;
    for (int i = 0; i < turns; ++i) sum += (pixel_at(camera, two_pi * i / turns) - middle).norm();
    return sum / turns;
}

BallOutline find_ball(const ImageF& radiance, const Camera& camera, const std::optional<OutlineCircle>& given,
                      const std::filesystem::path& reported) {
    const cv::Mat light = log_light(radiance);
    // In a very large picture the reflections' edges are many and the rim is as sharp as in one of this size.
    constexpr double enough_px = 1200;
    const double scale = std::min(1.0, enough_px / std::max(light.cols, light.rows));
    cv::Mat small = light;
    Camera small_camera = camera;
    if (scale < 1) {
        cv::resize(light, small, {}, scale, scale, cv::INTER_AREA);
        small_camera = camera_for_size(camera, small.cols, small.rows, reported);
    }
    std::vector<OutlineCircle> circles;
    if (given) {
        circles.push_back({((given->centre_px.array() + 0.5) * scale - 0.5).matrix(), given->radius_px * scale});
    } else {
        circles = proposed_circles(small);
    }
    std::optional<BallOutline> best = best_outline(small, small_camera, circles);
    // Who gives a circle has seen the ball.
    const double least = given ? least_significance / 3 : least_significance;
    if (!best || best->significance < least) {
        throw InputError(
            reported,
            fmt::format("no ball: looked for a circle that more edges lie on than chance explains; the best "
                        "of {} has {:.1f} standard deviations more, not {:.0f}",
                        circles.size(), best ? best->significance : 0, least),
            given ? "is the circle right?" : "give its circle by hand: --circle X,Y,RADIUS in pixels");
    }
    if (best->share_in_frame < 0.98) {
        throw InputError(
            reported,
            fmt::format("the frame cuts the ball: {:.0f} % of its outline lie inside", 100 * best->share_in_frame),
            "photograph the whole ball");
    }
    if (scale < 1) {
        OutlineFit fit(light, camera, *best);
        const double significance = best->significance;
        if (fit.refine()) best = fit.outline();
        best->significance = significance;
    }
    return *best;
}

}  // namespace matchlight
