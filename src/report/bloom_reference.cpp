// Separable convolution; rows without light cost nothing.
#include "report/bloom_reference.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "render/effects/bloom_model.h"
#include "report/squeezed_reference.h"

namespace matchlight {
namespace {

/// From the middle to one side, of unit sum over both: a Gaussian sampled at whole numbers that has this very standard
/// deviation then (below about 1 sampling makes it narrower).
std::vector<double> taps_of(double sigma, double cut_sigmas) {
    const int radius = static_cast<int>(std::ceil(cut_sigmas * sigma));
    std::vector<double> taps(static_cast<std::size_t>(radius) + 1);
    const auto sample = [&](double sampled_sigma) {
        double sum = 0, squares = 0;
        for (int i = 0; i <= radius; ++i) {
            double& tap = taps[static_cast<std::size_t>(i)];
            tap = std::exp(-0.5 * i * i / (sampled_sigma * sampled_sigma));
            sum += (i == 0 ? 1 : 2) * tap;
            squares += 2.0 * i * i * tap;
        }
        for (double& tap : taps) tap /= sum;
        return std::sqrt(squares / sum);
    };
    double low = 0.01, high = 2 * sigma + 1;
    for (int step = 0; step < 60; ++step) {
        const double middle = (low + high) / 2;
        (sample(middle) < sigma ? low : high) = middle;
    }
    sample(high);
    return taps;
}

bool is_dark(std::span<const double> row) {
    return std::all_of(row.begin(), row.end(), [](double value) { return value == 0; });
}

}  // namespace

ImageD gaussian_blurred(const ImageD& image, double sigma_x, double sigma_y, double cut_sigmas) {
    const std::vector<double> taps_x = taps_of(sigma_x, cut_sigmas), taps_y = taps_of(sigma_y, cut_sigmas);
    const int width = image.width(), height = image.height();
    const int radius_x = static_cast<int>(taps_x.size()) - 1, radius_y = static_cast<int>(taps_y.size()) - 1;
    std::vector<int> lit_rows;
    for (int y = 0; y < height; ++y) {
        if (!is_dark(image.row(y))) lit_rows.push_back(y);
    }
    ImageD across(width, height, 3);
    parallel_for(static_cast<int>(lit_rows.size()), [&](int i) {
        const int y = lit_rows[static_cast<std::size_t>(i)];
        for (int from = 0; from < width; ++from) {
            const double* light = image.pixel(from, y);
            if (light[0] == 0 && light[1] == 0 && light[2] == 0) continue;
            for (int x = std::max(0, from - radius_x); x <= std::min(width - 1, from + radius_x); ++x) {
                const double tap = taps_x[static_cast<std::size_t>(std::abs(x - from))];
                for (int c = 0; c < 3; ++c) across.at(x, y, c) += tap * light[c];
            }
        }
    });
    ImageD blurred(width, height, 3);
    parallel_for(height, [&](int y) {
        const std::span<double> row = blurred.row(y);
        for (const int from : lit_rows) {
            if (std::abs(y - from) > radius_y) continue;
            const double tap = taps_y[static_cast<std::size_t>(std::abs(y - from))];
            const std::span<const double> source = across.row(from);
            for (std::size_t i = 0; i < row.size(); ++i) row[i] += tap * source[i];
        }
    });
    return blurred;
}

ImageD reference_bloom(const ImageD& bright_light, const BloomSettings& settings, double cut_sigmas) {
    ImageD bloom(bright_light.width(), bright_light.height(), 3);
    for (const BloomGaussian& gaussian : bloom_gaussians(settings, bright_light.height())) {
        const ImageD blurred = gaussian_blurred(bright_light, gaussian.sigma_px, gaussian.sigma_px, cut_sigmas);
        for (std::size_t i = 0; i < bloom.samples().size(); ++i) {
            bloom.samples()[i] += settings.strength * gaussian.weight * blurred.samples()[i];
        }
    }
    return bloom;
}

ImageD reference_classic_bloom(const ImageD& bright_light, const BloomSettings& settings, double cut_sigmas) {
    ImageD bloom(bright_light.width(), bright_light.height(), 3);
    const double sigma = classic_bloom_sigma_texels(settings);
    ImageD square = bright_light;
    for (const int size : classic_bloom_sizes) {
        square = gaussian_blurred(squeezed(square, size, size), sigma, sigma, cut_sigmas);
        add_magnified(square, settings.strength / static_cast<double>(std::size(classic_bloom_sizes)), bloom);
    }
    return bloom;
}

}  // namespace matchlight
