// Sampled Gaussians in double precision.
#include "report/softness_reference.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.h"

namespace matchlight {
namespace {

/// Weights from -radius to radius, of sum 1.
std::vector<double> weights_of(double sigma, int radius) {
    std::vector<double> weights;
    double sum = 0;
    for (int i = -radius; i <= radius; ++i) {
        weights.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
        sum += weights.back();
    }
    for (double& weight : weights) weight /= sum;
    return weights;
}

double variance_of(const std::vector<double>& weights) {
    const double middle = (static_cast<double>(weights.size()) - 1) / 2;
    double variance = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        variance += weights[i] * std::pow(static_cast<double>(i) - middle, 2);
    }
    return variance;
}

/// Along rows, into columns of the result: twice is both axes.
ImageD transposed_blur(const ImageD& image, const std::vector<double>& weights) {
    const int radius = static_cast<int>(weights.size() / 2);
    ImageD blurred(image.height(), image.width(), image.channels());
    parallel_for(image.height(), [&](int y) {
        for (int x = 0; x < image.width(); ++x) {
            for (int i = -radius; i <= radius; ++i) {
                const double* from = image.pixel(std::clamp(x + i, 0, image.width() - 1), y);
                for (int c = 0; c < image.channels(); ++c) {
                    blurred.at(y, x, c) += weights[static_cast<std::size_t>(i + radius)] * from[c];
                }
            }
        }
    });
    return blurred;
}

}  // namespace

ImageD reference_softness(const ImageD& image, double sigma_px) {
    if (!(sigma_px > 0)) return image;
    const int radius = static_cast<int>(std::ceil(8 * sigma_px));
    // Sampling makes narrow Gaussians narrower: the one is found that has the variance afterwards.
    double low = 0.05, high = 2 * sigma_px + 1;
    for (int step = 0; step < 60; ++step) {
        const double middle = (low + high) / 2;
        (variance_of(weights_of(middle, radius)) < sigma_px * sigma_px ? low : high) = middle;
    }
    const std::vector<double> weights = weights_of(high, radius);
    return transposed_blur(transposed_blur(image, weights), weights);
}

}  // namespace matchlight
