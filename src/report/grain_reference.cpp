// Each pixel's noise as the sum over its neighbourhood, with quantiles by Newton's method.
#include "report/grain_reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"

namespace matchlight {
namespace {

/// The value of a standard normal distribution that a share of it lies below.
double normal_value(double share) {
    double z = 0;
    constexpr int most_steps = 100;
    for (int step = 0; step < most_steps; ++step) {
        const double error = 0.5 * std::erfc(-z / std::numbers::sqrt2) - share;
        const double density = std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
        // Far out the density is small: steps of more than 1 leave the tail.
        z -= std::clamp(error / density, -1.0, 1.0);
    }
    return z;
}

}  // namespace

ImageD reference_grain_noise(const GrainModel& model, const Region& region) {
    constexpr int values = 1 << grain_quantile_bits;
    std::vector<double> table;
    double squares = 0;
    for (int i = 0; i < values; ++i) {
        table.push_back(normal_value((i + 0.5) / values));
        squares += table.back() * table.back() / values;
    }
    for (double& value : table) value /= std::sqrt(squares);

    const double sigma = model.correlation_px;
    const int radius = sigma < least_grain_correlation_px ? 0 : static_cast<int>(std::ceil(6 * sigma));
    const auto weight = [&](int x, int y) {
        return radius == 0 ? 1.0 : std::exp(-0.5 * (x * x + y * y) / (sigma * sigma));
    };
    double power = 0;
    for (int y = -radius; y <= radius; ++y) {
        for (int x = -radius; x <= radius; ++x) power += weight(x, y) * weight(x, y);
    }
    ImageD noise(region.width, region.height, 3);
    parallel_for(region.height, [&](int row) {
        for (int column = 0; column < region.width; ++column) {
            for (int y = -radius; y <= radius; ++y) {
                for (int x = -radius; x <= radius; ++x) {
                    const auto words = pcg4d({static_cast<std::uint32_t>(region.x + column + x),
                                              static_cast<std::uint32_t>(region.y + row + y), model.frame, model.seed});
                    for (int c = 0; c < 3; ++c) {
                        const std::uint32_t chosen = words[static_cast<std::size_t>(c)] >> (32 - grain_quantile_bits);
                        noise.at(column, row, c) += weight(x, y) * table[chosen] / std::sqrt(power);
                    }
                }
            }
        }
    });
    return noise;
}

double reference_grain_deviation(const GrainModel& model, const GrainLight& pixel) {
    const auto variance = [&](double light) {
        return model.read * model.read + model.shot * std::clamp(light, 0.0, model.brightest);
    };
    const double missing = variance(pixel.light) - pixel.kept * pixel.kept * variance(pixel.plate);
    return model.strength * std::sqrt(std::max(missing, 0.0));
}

}  // namespace matchlight
