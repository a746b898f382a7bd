// A kernel for each direction, and its sum over all pixels that have light.
#include "report/streaks_reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/parallel.h"
#include "render/effects/streaks_model.h"
#include "report/squeezed_reference.h"

namespace matchlight {
namespace {

/// exp(x²)·erfc(x), where exp(x²) alone would overflow: its continued fraction (Abramowitz & Stegun 1964, 7.1.14).
double scaled_erfc(double x) {
    if (x < 20) return std::exp(x * x) * std::erfc(x);
    return 1 / (std::sqrt(std::numbers::pi) * (x + 0.5 / (x + 1 / x)));
}

/// Light at `u` along and `v` across a streak that starts at 0: ∫₀^L exp(−λt) G(u − t) dt · G(v), G the Gaussian of σ,
/// but for a constant factor.
class StreakKernel {
public:
    explicit StreakKernel(const StreakShape& shape)
        : sigma_(shape.sigma_px),
          length_(shape.length_px),
          // exp(−λ·step) is the attenuation; 0 is a streak shorter than anything seen.
          decay_(-std::log(std::max(shape.attenuation, 1e-30)) / shape.step_px) {}

    double at(double u, double v) const {
        // The integral completes the square: exp(−u²/2σ²)/2 · [w(a) − exp(…)·w(b)], w(x) = exp(x²)·erfc(x).
        const double root = std::sqrt(2.0) * sigma_;
        const double start = (decay_ * sigma_ * sigma_ - u) / root;
        const double end = start + length_ / root;
        const double across = std::exp(-0.5 * v * v / (sigma_ * sigma_));
        if (start > 0) {
            // Before the streak's start, or short of its Gaussian's shift: both terms are tails.
            return across * std::exp(-0.5 * u * u / (sigma_ * sigma_)) *
                   (scaled_erfc(start) - std::exp(start * start - end * end) * scaled_erfc(end));
        }
        return across * std::exp(0.5 * decay_ * decay_ * sigma_ * sigma_ - decay_ * u) *
               (std::erfc(start) - std::erfc(end));
    }

private:
    double sigma_, length_, decay_;
};

/// The part of a kernel that lands `dy` rows below its source.
struct KernelRow {
    int dy = 0, first_dx = 0;
    std::vector<double> weights;
};

std::vector<KernelRow> kernel_of(const StreakShape& shape, double angle, double cut_sigmas) {
    const StreakKernel kernel(shape);
    const double right = std::cos(angle), down = -std::sin(angle);
    const double margin = cut_sigmas * shape.sigma_px;
    const auto span = [&](double direction) {
        const double end = direction * shape.length_px;
        return std::pair{static_cast<int>(std::floor(std::min(0.0, end) - margin)),
                         static_cast<int>(std::ceil(std::max(0.0, end) + margin))};
    };
    const auto [left, last_column] = span(right);
    const auto [top, last_row] = span(down);
    std::vector<KernelRow> rows;
    double sum = 0;
    for (int dy = top; dy <= last_row; ++dy) {
        KernelRow row{.dy = dy, .first_dx = 0, .weights = {}};
        for (int dx = left; dx <= last_column; ++dx) {
            const double u = dx * right + dy * down, v = dx * down - dy * right;
            if (std::abs(v) > margin || u < -margin || u > shape.length_px + margin) continue;
            if (row.weights.empty()) row.first_dx = dx;
            row.weights.push_back(kernel.at(u, v));
            sum += row.weights.back();
        }
        if (!row.weights.empty()) rows.push_back(std::move(row));
    }
    for (KernelRow& row : rows) {
        for (double& weight : row.weights) weight /= sum;
    }
    return rows;
}

/// The columns of every row that have light.
std::vector<std::vector<int>> lit_columns(const ImageD& light) {
    std::vector<std::vector<int>> columns(static_cast<std::size_t>(light.height()));
    for (int y = 0; y < light.height(); ++y) {
        for (int x = 0; x < light.width(); ++x) {
            const double* p = light.pixel(x, y);
            if (p[0] != 0 || p[1] != 0 || p[2] != 0) columns[static_cast<std::size_t>(y)].push_back(x);
        }
    }
    return columns;
}

}  // namespace

ImageD reference_streaks(const ImageD& bright_light, const GlareSettings& settings, double cut_sigmas) {
    const int width = bright_light.width(), height = bright_light.height();
    const StreakShape shape = streak_shape(settings, height);
    const std::vector<std::vector<int>> lit = lit_columns(bright_light);
    const double share = settings.strength / settings.directions;
    ImageD streaks(width, height, 3);
    for (const double angle : streak_angles(settings)) {
        const std::vector<KernelRow> kernel = kernel_of(shape, angle, cut_sigmas);
        parallel_for(height, [&](int y) {
            for (const KernelRow& row : kernel) {
                const int from_y = y - row.dy;
                if (from_y < 0 || from_y >= height) continue;
                for (const int from_x : lit[static_cast<std::size_t>(from_y)]) {
                    const double* light = bright_light.pixel(from_x, from_y);
                    const int first = from_x + row.first_dx;
                    const int last = std::min(width, first + static_cast<int>(row.weights.size()));
                    for (int x = std::max(0, first); x < last; ++x) {
                        const double weight = share * row.weights[static_cast<std::size_t>(x - first)];
                        for (int c = 0; c < 3; ++c) streaks.at(x, y, c) += weight * light[c];
                    }
                }
            }
        });
    }
    return streaks;
}

ImageD reference_classic_streaks(const ImageD& bright_light, const GlareSettings& settings) {
    constexpr int size = classic_streak_size;
    const ImageD square = squeezed(bright_light, size, size);
    const int taps = static_cast<int>(std::exp2(2 * settings.passes));
    const double gain = (1 - std::pow(settings.attenuation, taps)) / (1 - settings.attenuation);
    ImageD streaks(size, size, 3);
    for (const auto& [right, down] : {std::pair{1, 1}, {1, -1}, {-1, 1}, {-1, -1}}) {
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                double weight = settings.strength / 4 / gain;
                for (int i = 0; i < taps; ++i, weight *= settings.attenuation) {
                    const int from_x = x - i * right, from_y = y - i * down;
                    if (!square.bounds().contains(from_x, from_y)) break;
                    for (int c = 0; c < 3; ++c) streaks.at(x, y, c) += weight * square.at(from_x, from_y, c);
                }
            }
        }
    }
    ImageD magnified(bright_light.width(), bright_light.height(), 3);
    add_magnified(streaks, 1, magnified);
    return magnified;
}

}  // namespace matchlight
