// Chooses exposures by the ACES curve, and takes the largest error over them.
#include "report/hdr_flip.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "core/transfer.h"

namespace matchlight {
namespace {

/// (k0 x² + k1 x + k2) / (k3 x² + k4 x + k5), Narkowicz' fit with x = 0.6 · light.
constexpr std::array<double, 6> aces{0.6 * 0.6 * 2.51, 0.6 * 0.03, 0, 0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14};

/// The light that the curve maps to 0.85 of white: where the paper lets the display begin to saturate.
double light_near_white() {
    constexpr double near_white = 0.85;
    const double a = aces[0] - near_white * aces[3];
    const double b = aces[1] - near_white * aces[4];
    const double c = aces[2] - near_white * aces[5];
    return -b / (2 * a) + std::sqrt(b * b / (4 * a * a) - c / a);
}

float tone_curve(double light) {
    const double x = std::max(light, 0.0);
    // Beyond any display's range the squares of huge light would overflow; the curve is flat there.
    if (x > 1e100) return 1.0f;
    const double mapped = (aces[0] * x * x + aces[1] * x + aces[2]) / (aces[3] * x * x + aces[4] * x + aces[5]);
    return static_cast<float>(std::clamp(mapped, 0.0, 1.0));
}

}  // namespace

ExposureRange hdr_flip_exposures(const ImageF& reference) {
    assert(reference.channels() == 3);
    std::vector<double> luminance;
    luminance.reserve(reference.samples().size() / 3);
    for (int y = 0; y < reference.height(); ++y) {
        for (int x = 0; x < reference.width(); ++x) {
            const float* p = reference.pixel(x, y);
            luminance.push_back(luminance_rec709(p[0], p[1], p[2]));
        }
    }
    const auto median_of = [](std::vector<double>& values) {
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::nth_element(values.begin(), middle, values.end());
        return *middle;
    };
    if (luminance.empty()) return {0, 0, 1};
    const double brightest = *std::max_element(luminance.begin(), luminance.end());
    if (!(brightest > 0)) return {0, 0, 1};
    double median = median_of(luminance);
    if (!(median > 0)) {
        std::erase_if(luminance, [](double value) { return !(value > 0); });
        median = median_of(luminance);
    }
    ExposureRange range;
    range.start_ev = std::log2(light_near_white() / brightest);
    range.stop_ev = std::log2(light_near_white() / median);
    range.count = std::max(2, static_cast<int>(std::ceil(range.stop_ev - range.start_ev)));
    return range;
}

ImageF tone_mapped(const ImageF& light, double exposure_ev) {
    ImageF mapped(light.width(), light.height(), light.channels());
    const double scale = std::exp2(exposure_ev);
    parallel_for(light.height(), [&](int y) {
        std::ranges::transform(light.row(y), mapped.row(y).begin(),
                               [=](float value) { return tone_curve(scale * static_cast<double>(value)); });
    });
    return mapped;
}

ImageF hdr_flip_error_map(const ImageF& reference, const ImageF& test, const FlipOptions& options) {
    assert(reference.bounds() == test.bounds());
    const ExposureRange range = hdr_flip_exposures(reference);
    ImageF largest(reference.width(), reference.height(), 1);
    for (int i = 0; i < range.count; ++i) {
        const double step_ev = range.count > 1 ? (range.stop_ev - range.start_ev) / (range.count - 1) : 0;
        const double exposure_ev = range.start_ev + i * step_ev;
        const ImageF map =
            flip_error_map_of_light(tone_mapped(reference, exposure_ev), tone_mapped(test, exposure_ev), options);
        std::ranges::transform(largest.samples(), map.samples(), largest.samples().begin(),
                               [](float a, float b) { return std::max(a, b); });
    }
    return largest;
}

}  // namespace matchlight
