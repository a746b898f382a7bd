// Weighted sums over lines and discs.
#include "report/defocus_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace matchlight {

namespace {

double overlap(double radius_px, double away_px) {
    return std::clamp(radius_px - away_px + 0.5, 0.0, 1.0);
}

/// Overlap · intensity · leakage control, as shaders/effects/depth_of_field/weights.glsl has it.
struct Weights {
    double largest_radius_px = 0;

    double radius_px(double coc_px) const { return std::clamp(std::abs(coc_px) / 2, 0.5, largest_radius_px); }
    double covers(double radius_px, double away_px) const {
        return overlap(radius_px, away_px) / (radius_px * radius_px);
    }
    double leakage(double own_coc_px, double coc_px) const {
        if (std::isnan(own_coc_px) || coc_px <= own_coc_px) return 1;
        if (std::abs(own_coc_px) < least_coc_px) return 0;
        return std::min(1.0, std::pow(radius_px(own_coc_px) / radius_px(coc_px), 2));
    }
};

struct Gathered {
    std::array<double, 4> light{};
    double coc_px = 0;  // the pixel's own, or what light goes on with
};

Gathered gathered(const DefocusImages& images, const Weights& weights, std::span<const DefocusTap> taps, int x, int y) {
    const double own = images.coc_px.at(x, y);
    const bool covered = !std::isnan(own);
    Gathered result{.coc_px = own};
    double weight = 0, plate = 0, radius = 0, coc = 0;
    for (const DefocusTap& tap : taps) {
        const int u = x + tap.x, v = y + tap.y;
        if (!images.light.bounds().contains(u, v)) continue;
        const double away = std::hypot(tap.x, tap.y);
        if (!images.covered(u, v)) {
            if (covered) plate += tap.area_px2 * weights.covers(weights.radius_px(own), away);
            continue;
        }
        const double circle = images.coc_px.at(u, v), r = weights.radius_px(circle);
        const double w = tap.area_px2 * weights.covers(r, away) * weights.leakage(own, circle);
        for (int c = 0; c < 4; ++c) result.light[static_cast<std::size_t>(c)] += w * images.light.at(u, v, c);
        weight += w;
        radius += w * r;
        coc += w * circle;
    }
    if (weight == 0) return result;
    double whole = weight + plate;
    if (!covered) {
        const double mean_radius = radius / weight;
        result.coc_px = coc < 0 ? -2 * mean_radius : 2 * mean_radius;
        double all = 0;
        for (const DefocusTap& tap : taps) {
            if (images.light.bounds().contains(x + tap.x, y + tap.y))
                all += tap.area_px2 * weights.covers(mean_radius, std::hypot(tap.x, tap.y));
        }
        whole = std::max(all, weight);
    }
    for (double& value : result.light) value /= whole;
    return result;
}

DefocusImages blurred(const DefocusImages& images, const Weights& weights, std::span<const DefocusTap> taps) {
    DefocusImages result(images.light.width(), images.light.height());
    parallel_for(images.light.height(), [&](int y) {
        for (int x = 0; x < images.light.width(); ++x) {
            const Gathered sum = gathered(images, weights, taps, x, y);
            std::copy(sum.light.begin(), sum.light.end(), result.light.pixel(x, y));
            result.coc_px.at(x, y) = sum.coc_px;
        }
    });
    return result;
}

}  // namespace

DefocusImages::DefocusImages(int width, int height)
    : light(width, height, 4), coc_px(width, height, 1, std::numeric_limits<double>::quiet_NaN()) {}

bool DefocusImages::covered(int x, int y) const {
    return !std::isnan(coc_px.at(x, y));
}

void DefocusImages::set(int x, int y, double value, double signed_coc_px) {
    for (int c = 0; c < 3; ++c) light.at(x, y, c) = value;
    light.at(x, y, 3) = 1;
    coc_px.at(x, y) = signed_coc_px;
}

ImageD reference_two_pass(const DefocusImages& images, double largest_radius_px) {
    const Weights weights{largest_radius_px};
    const int reach = std::max(images.light.width(), images.light.height());
    std::vector<DefocusTap> across, down;
    for (int i = -reach; i <= reach; ++i) {
        across.push_back({.x = i, .y = 0});
        down.push_back({.x = 0, .y = i});
    }
    return blurred(blurred(images, weights, across), weights, down).light;
}

ImageD reference_one_pass(const DefocusImages& images, std::span<const DefocusTap> taps, double largest_radius_px) {
    return blurred(images, {largest_radius_px}, taps).light;
}

}  // namespace matchlight
