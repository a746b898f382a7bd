// Weighted sums over lines and discs.
#include "report/defocus_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/parallel.h"

namespace matchlight {

namespace {

double overlap(double radius_px, double away_px) {
    return std::clamp(radius_px - away_px + 0.5, 0.0, 1.0);
}

/// Overlap · intensity · leakage control, as shaders/effects/depth_of_field/weights.glsl has it.
struct DiscWeights {
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

Gathered gathered(const DefocusImages& images, const DiscWeights& weights, std::span<const DefocusTap> taps, int x,
                  int y) {
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

DefocusImages blurred(const DefocusImages& images, const DiscWeights& weights, std::span<const DefocusTap> taps) {
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

/// A row or a column of an image.
struct Line {
    int x = 0, y = 0;
    int step_x = 0, step_y = 0;
    int size = 0;
};

/// Circles where nothing is: between those beside it on the line.
void fill_circles(ImageD& coc_px, const Line& line) {
    const auto at = [&](int i) -> double& { return coc_px.at(line.x + i * line.step_x, line.y + i * line.step_y); };
    std::vector<int> known;
    for (int i = 0; i < line.size; ++i) {
        if (!std::isnan(at(i))) known.push_back(i);
    }
    if (known.empty()) return;
    for (int i = 0; i < line.size; ++i) {
        const auto next = std::upper_bound(known.begin(), known.end(), i);
        const int right = next == known.end() ? known.back() : *next;
        const int left = next == known.begin() ? known.front() : *(next - 1);
        const double t = left == right ? 0 : static_cast<double>(i - left) / (right - left);
        if (i != left) at(i) = std::lerp(std::abs(at(left)), std::abs(at(right)), t);
    }
}

void diffuse(ImageD& light, const ImageD& coc_px, const Line& line, int steps) {
    const auto n = static_cast<std::size_t>(line.size);
    const auto place = [&](std::size_t i) {
        return std::pair{line.x + static_cast<int>(i) * line.step_x, line.y + static_cast<int>(i) * line.step_y};
    };
    const auto conductivity = [&](std::size_t i) {
        const auto [x, y] = place(i);
        const double circle = std::abs(coc_px.at(x, y));
        return circle >= least_coc_px ? circle * circle / (32.0 * steps) : 0.0;
    };
    std::vector<double> between(n, 0.0), share(n);
    for (std::size_t i = 0; i + 1 < n; ++i) between[i] = std::min(conductivity(i), conductivity(i + 1));
    std::vector<double> solved(n);
    for (int c = 0; c < 4; ++c) {
        double before = 0, w = 0, last = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const auto [x, y] = place(i);
            const double own = 1 + before * w, divisor = own + between[i];
            solved[i] = last = (light.at(x, y, c) + before * last) / divisor;
            share[i] = between[i] / divisor;
            w = own / divisor;
            before = between[i];
        }
        last = 0;
        for (std::size_t i = n; i-- > 0;) {
            const auto [x, y] = place(i);
            light.at(x, y, c) = last = solved[i] + share[i] * last;
        }
    }
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
    const DiscWeights weights{largest_radius_px};
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

ImageD reference_layers(const DefocusImages& images, const SlicedReference& sliced) {
    const int width = images.light.width(), height = images.light.height();
    ImageD result(width, height, 4);
    for (const DefocusSlice& slice : sliced.slices) {
        std::vector<DefocusTap> taps{{}};
        if (slice.circle_px != 0) taps = bokeh_taps(sliced.bokeh, std::abs(slice.circle_px) / 2, slice.circle_px < 0);
        parallel_for(height, [&](int y) {
            for (int x = 0; x < width; ++x) {
                std::array<double, 4> front{};
                double known = 0;
                for (const DefocusTap& tap : taps) {
                    const int u = x + tap.x, v = y + tap.y;
                    if (!images.light.bounds().contains(u, v)) continue;
                    known += tap.area_px2;
                    const double circle = images.coc_px.at(u, v);
                    if (!(circle >= slice.from_px && circle < slice.to_px)) continue;
                    for (int c = 0; c < 4; ++c)
                        front[static_cast<std::size_t>(c)] += tap.area_px2 * images.light.at(u, v, c);
                }
                if (known > 0) {
                    for (double& value : front) value /= known;
                }
                double* behind = result.pixel(x, y);
                const double left = 1 - front[3];
                const double share = sliced.disjoint && behind[3] > 0 ? std::clamp(left / behind[3], 0.0, 1.0) : left;
                for (int c = 0; c < 4; ++c) behind[c] = front[static_cast<std::size_t>(c)] + share * behind[c];
            }
        });
    }
    return result;
}

ImageD reference_diffusion(const DefocusImages& images, int steps) {
    const int width = images.light.width(), height = images.light.height();
    ImageD light = images.light, coc_px = images.coc_px;
    for (int step = 0; step < steps; ++step) {
        for (int y = 0; y < height; ++y) {
            const Line row{.x = 0, .y = y, .step_x = 1, .step_y = 0, .size = width};
            fill_circles(coc_px, row);
            diffuse(light, coc_px, row, steps);
        }
        for (int x = 0; x < width; ++x) {
            const Line column{.x = x, .y = 0, .step_x = 0, .step_y = 1, .size = height};
            fill_circles(coc_px, column);
            diffuse(light, coc_px, column, steps);
        }
    }
    return light;
}

}  // namespace matchlight
