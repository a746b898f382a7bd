// The formulas of surface/patterns.glsl without their filters; a Gaussian by even shares of its distribution.
#include "report/pattern_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace matchlight {

namespace {

using Eigen::Vector3d;
using std::numbers::pi;

double fraction(double x) {
    return x - std::floor(x);
}

/// The shader's pcg3d.
std::uint32_t scrambled_cell(std::array<std::uint32_t, 3> v) {
    for (std::uint32_t& one : v) one = one * 1664525U + 1013904223U;
    const auto stir = [&] {
        v[0] += v[1] * v[2];
        v[1] += v[2] * v[0];
        v[2] += v[0] * v[1];
    };
    stir();
    for (std::uint32_t& one : v) one ^= one >> 16U;
    stir();
    return v[0];
}

double slope_at(const std::array<std::int64_t, 3>& corner, const Vector3d& from) {
    const std::uint32_t edge =
        scrambled_cell({static_cast<std::uint32_t>(corner[0]), static_cast<std::uint32_t>(corner[1]),
                        static_cast<std::uint32_t>(corner[2])}) %
        12U;
    const double a = edge < 4 ? from.y() : from.x();
    const double b = edge < 8 ? from.z() : from.y();
    return ((edge & 1U) == 0 ? a : -a) + ((edge & 2U) == 0 ? b : -b);
}

double gradient_noise(const Vector3d& p) {
    const Vector3d cell(std::floor(p.x()), std::floor(p.y()), std::floor(p.z()));
    const Vector3d f = p - cell;
    double sum = 0;
    for (int i = 0; i < 8; ++i) {
        const Vector3d corner(i & 1, (i >> 1) & 1, i >> 2);
        double weight = 1;
        for (int c = 0; c < 3; ++c) {
            const double s = f[c] * f[c] * f[c] * (f[c] * (f[c] * 6 - 15) + 10);
            weight *= corner[c] == 1 ? s : 1 - s;
        }
        sum += weight * slope_at({std::llround(cell.x() + corner.x()), std::llround(cell.y() + corner.y()),
                                  std::llround(cell.z() + corner.z())},
                                 f - corner);
    }
    return sum;
}

double octaves_of_noise(const Vector3d& p, int octaves) {
    double sum = 0, height = 1, scale = 1;
    for (int i = 0; i < octaves; ++i) {
        sum += height * gradient_noise(p * scale + Vector3d::Constant(17.0 * i));
        height /= 2;
        scale *= 2;
    }
    return sum;
}

/// How many standard deviations this share of a Gaussian lies below.
double gaussian_quantile(double share) {
    double low = -8, high = 8;
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (std::erfc(-middle / std::numbers::sqrt2) / 2 < share ? low : high) = middle;
    }
    return (low + high) / 2;
}

}  // namespace

Vector3d pattern_color(const PatternSettings& pattern, const Vector3d& point) {
    const Vector3d color(pattern.color.data()), second(pattern.second_color.data());
    const Vector3d middle =
        pattern.middle_color ? Vector3d(pattern.middle_color->data()) : Vector3d((color + second) / 2);
    const Vector3d direction = Vector3d(pattern.direction.data()).normalized();
    const Vector3d p = pattern.frequency * point;
    const auto ramp = [&](double t) -> Vector3d {
        const double twice = 2 * std::clamp(t, 0.0, 1.0);
        return twice < 1 ? second + twice * (middle - second) : middle + (twice - 1) * (color - middle);
    };
    switch (pattern.kind) {
        case PatternKind::square_wave:
            return fraction(p.dot(direction)) < pattern.share ? color : second;
        case PatternKind::checker: {
            int odd = 0;
            for (int c = 0; c < 3; ++c) odd += fraction(p[c] / 2 + 0.25) < 0.5 ? 0 : 1;
            return odd % 2 == 0 ? color : second;
        }
        case PatternKind::noise:
            return ramp(0.5 + 0.5 * octaves_of_noise(p, pattern.octaves));
        case PatternKind::wood:
        case PatternKind::marble:
            break;
    }
    const bool is_wood = pattern.kind == PatternKind::wood;
    const Vector3d along = p.dot(direction) * direction;
    const Vector3d bent = 0.5 * (is_wood ? Vector3d(p - 0.85 * along) : p);
    const double way = is_wood ? (p - along).norm() : p.dot(direction);
    const double phase = way + pattern.turbulence * octaves_of_noise(bent, pattern.octaves);
    double t = is_wood ? 0.5 : 1 - 2 / pi;
    for (int k = 1; k <= (is_wood ? 5 : 6); ++k) {
        const double turn = pi * k / 6;
        t += is_wood ? std::sin(turn) / turn / (pi * k) * std::sin(2 * pi * k * phase)
                     : 4 / pi / (4 * k * k - 1) * std::cos(2 * pi * k * phase);
    }
    return ramp(t);
}

Vector3d filtered_pattern(const PatternSettings& pattern, const std::function<Vector3d(double, double)>& at, int side) {
    // surface/patterns.glsl: a tenth of a wave of half a period a pixel is left.
    const double deviation_px = std::sqrt(std::log(10.0) / (2 * pi * pi * 0.25));
    std::vector<double> aside;
    for (int i = 0; i < side; ++i) aside.push_back(deviation_px * gaussian_quantile((i + 0.5) / side));
    Vector3d sum = Vector3d::Zero();
    for (const double y : aside) {
        for (const double x : aside) sum += pattern_color(pattern, at(x, y));
    }
    return sum / (static_cast<double>(side) * side);
}

}  // namespace matchlight
