// Sampling of paper and ink.
#include "tracking/grey_card.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "tracking/tag_pixels.h"

namespace matchlight {

namespace {

struct PurePixel {
    std::array<float, 3> light{};
    double margin_px = 0;  // distance to the nearest edge
    bool paper = false;
};

struct TrimmedMean {
    double mean = 0, standard_error = 0;
};

/// Mean of the middle half: a glint or a shadow over less than a quarter of the cells moves it little.
TrimmedMean interquartile_mean(std::vector<double> values) {
    const std::size_t from = values.size() / 4, to = values.size() - from;
    const auto at = [&](std::size_t index) { return values.begin() + static_cast<std::ptrdiff_t>(index); };
    std::nth_element(values.begin(), at(from), values.end());
    std::nth_element(at(from), at(to - 1), values.end());
    double sum = 0;
    for (std::size_t i = from; i < to; ++i) sum += values[i];
    const double mean = sum / static_cast<double>(to - from);
    // For normal noise the quartiles lie ±0.674 σ from the mean; neighbouring pixels share coding noise, so a quarter
    // of them count as independent.
    const double sigma = (values[to - 1] - values[from]) / (2 * 0.674);
    return {mean, sigma / std::sqrt(0.25 * static_cast<double>(values.size()))};
}

std::vector<PurePixel> pure_pixels(const PlateFrame& frame, const PlateLight& plate_light, const LensGrid& lens,
                                   const BlurredPattern& pattern, const TagImageFit& fit) {
    const Region frame_bounds{0, 0, frame.format().width, frame.format().height};
    const Region box =
        region_of_grid(fit.grid_from_normalized, pattern.cells(), lens.camera()).intersected(frame_bounds);
    if (box.empty()) return {};
    const double cell_px = std::min(fit.cell_px[0], fit.cell_px[1]);
    const double blur_px = std::max(fit.observation.blur_px[0], fit.observation.blur_px[1]);
    const double least_margin_px = std::max(1.0, 2.5 * blur_px);
    const ImageF light = plate_light.rgb(frame, box);
    std::vector<PurePixel> pixels;
    for (int y = 0; y < box.height; ++y) {
        for (int x = 0; x < box.width; ++x) {
            const Eigen::Vector2d normalized = lens.normalized_from_pixel(box.x + x, box.y + y);
            const Eigen::Vector3d grid = fit.grid_from_normalized * normalized.homogeneous();
            const double a = grid.x() / grid.z(), b = grid.y() / grid.z();
            if (!pattern.is_known(a, b)) continue;
            const double margin_px = pattern.distance_to_edge(a, b) * cell_px;
            if (margin_px < least_margin_px) continue;
            const AxisFootprint sharp{1e-3, 1e-3};
            const float* sample = light.pixel(x, y);
            pixels.push_back(
                {{sample[0], sample[1], sample[2]}, margin_px, pattern.at(a, b, sharp, sharp, 0).paper > 0.5});
        }
    }
    return pixels;
}

}  // namespace

std::optional<CardReading> read_card(const PlateFrame& frame, const PlateLight& plate_light, const LensGrid& lens,
                                     const TagPattern& tag, const TagImageFit& fit) {
    const BlurredPattern pattern(tag);
    std::vector<PurePixel> pixels = pure_pixels(frame, plate_light, lens, pattern, fit);
    constexpr double chroma_margin_px = 2.5;
    constexpr std::ptrdiff_t enough_pixels = 40, fewest_pixels = 12;
    const auto count_of = [&](bool paper, double margin_px) {
        return std::ranges::count_if(pixels,
                                     [&](const PurePixel& p) { return p.paper == paper && p.margin_px >= margin_px; });
    };
    if (count_of(true, chroma_margin_px) >= enough_pixels && count_of(false, chroma_margin_px) >= enough_pixels) {
        std::erase_if(pixels, [&](const PurePixel& p) { return p.margin_px < chroma_margin_px; });
    }
    if (count_of(true, 0) < fewest_pixels || count_of(false, 0) < fewest_pixels) return std::nullopt;

    CardReading reading;
    reading.id = fit.observation.id;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        std::vector<double> paper, ink;
        std::size_t clipped = 0;
        for (const PurePixel& pixel : pixels) {
            (pixel.paper ? paper : ink).push_back(pixel.light[channel]);
            if (pixel.paper && pixel.light[channel] >= plate_light.clipped_light(static_cast<int>(channel))) ++clipped;
        }
        const TrimmedMean white = interquartile_mean(paper), black = interquartile_mean(ink);
        // A few clipped pixels are noise or a glint, and trimmed away; more, and the mean is only a lower bound.
        const bool clipped_paper = clipped * 10 >= paper.size();
        constexpr double darkest = 1e-4;  // below a fortieth of an 8-bit code nothing is known
        const double difference = white.mean - black.mean;
        reading.difference[channel] = {
            difference, std::hypot(white.standard_error, black.standard_error) / std::max(difference, darkest),
            !clipped_paper && difference > darkest};
        reading.ink[channel] = {black.mean, black.standard_error / std::max(black.mean, darkest), black.mean > darkest};
    }
    return reading;
}

}  // namespace matchlight
