// What is near a mirror ball, as it is seen from the probe's place, and which of the ball's views show it.
#include "lighting/ball_depth.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "lighting/latlong_lookup.h"
#include "lighting/probe.h"

namespace matchlight {
namespace {

/// Steps of nearness, which are half a pixel of the maps each. A place lies on a view's surface where they differ by no
/// more than the pixel that the maps round to, before or behind it where by more than the two pixels of two maps.
constexpr double on_surface_steps = 2, off_surface_steps = 4;
/// Past the same pixel a view does not show what lies behind its surface.
constexpr double hidden_steps = on_surface_steps;

}  // namespace

BallDepth::BallDepth(const BallScene& scene, const Eigen::Vector3d& place_m, const BallUnwrap& unwrap, int height)
    : scene_(scene), place_m_(place_m), scale_(nearness_scale(scene, height)), nearness_(2 * height, height, 1) {
    for (const BallView& view : scene.views) eyes_.push_back(view.eye_m());
    maps_ = ball_depth_maps(scene, unwrap, scale_, height);
    parallel_for(height, [&](int y) {
        for (int x = 0; x < 2 * height; ++x) {
            nearness_.at(x, y) = static_cast<float>(nearest(latlong_direction(x, y, 2 * height, height)));
        }
    });
    nearness_ = median_of(nearness_, 1);
    drop_specks(nearness_, scale_, [&](int x, int y) {
        return plane_nearness(scene, place_m, latlong_direction(x, y, 2 * height, height));
    });
}

Eigen::Vector3d BallDepth::place_of(const Eigen::Vector3d& towards, double nearness) const {
    return place_m_ + towards / std::max(nearness, scale_.farthest);
}

SeenPlace BallDepth::seen(std::size_t v, const Eigen::Vector3d& place_m) const {
    const Eigen::Vector3d& centre_m = scene_.ball.centre_m;
    Eigen::Vector3d normal = ((eyes_[v] - centre_m).normalized() + (place_m - centre_m).normalized()).normalized();
    return seen_place(scene_.ball, eyes_[v], place_m, 5, normal);
}

/// Where light is the same far and wide, a view's own distance is a guess: it is sure only if the nearer place does not
/// fit.
bool BallDepth::farther_is_sure(const BallDepthMap& map, int x, int y, double nearness) const {
    const float* costs = map.costs.at(x, y);
    const auto step = [&](double value) {
        return std::clamp(static_cast<int>(std::lround(value / scale_.step)), 0, scale_.steps);
    };
    return costs[step(nearness)] > costs[step(map.nearness.at(x, y))] + sure_ev;
}

/// The nearest surface that a view has there and that no view sees through; else the plane, or what is far.
double BallDepth::nearest(const Eigen::Vector3d& towards) const {
    const double plane = plane_nearness(scene_, place_m_, towards);
    const double last = std::max(plane, scale_.far);
    for (int l = scale_.steps; l * scale_.step > last; --l) {
        const Eigen::Vector3d place_m = place_of(towards, l * scale_.step);
        double sum = 0;
        int count = 0;
        bool through = false;
        for (std::size_t v = 0; v < maps_.size() && !through; ++v) {
            const SeenPlace there = seen(v, place_m);
            const BallDepthMap& map = maps_[v];
            const LatlongTaps at(there.towards, map.known.width(), map.known.height());
            const int x = at.nearest_x(), y = at.nearest_y();
            if (map.known.at(x, y) <= 0) continue;
            const double has = map.nearness.at(x, y);
            through =
                has < there.nearness - off_surface_steps * scale_.step && farther_is_sure(map, x, y, there.nearness);
            if (std::abs(has - there.nearness) > on_surface_steps * scale_.step) continue;
            const Eigen::Vector3d surface_m = there.point_m + there.towards / std::max(has, scale_.farthest);
            sum += 1 / (surface_m - place_m_).norm();
            ++count;
        }
        if (!through && count > 0) return std::max(plane, sum / count);
    }
    return plane;
}

double BallDepth::visible(std::size_t v, const Eigen::Vector3d& towards, double nearness) const {
    const SeenPlace there = seen(v, place_of(towards, nearness));
    const ImageF& map = maps_[v].nearness;
    const LatlongTaps at(there.towards, map.width(), map.height());
    double share = 0;
    for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 2; ++j) {
            if (map.at(at.x[i], at.y[j]) <= there.nearness + hidden_steps * scale_.step) share += at.share(i, j);
        }
    }
    return share;
}

}  // namespace matchlight
