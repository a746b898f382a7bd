// What readings of light consist of: exposure of the frame, light on the surface, fall-off of the lens.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <map>
#include <optional>
#include <vector>

namespace matchlight {

/// A tag's paper-minus-ink, or its ink alone.
struct CardSurface {
    int tag = 0;
    bool ink = false;
    auto operator<=>(const CardSurface&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
};

struct LogReading {
    std::size_t frame = 0;
    std::size_t channel = 0;
    CardSurface surface;
    double value = 0;     // natural log of reading over expectation
    double variance = 0;  // of `value`
    double radius = 0;    // 1 = the frame's corner
};

struct Vignette {
    std::array<double, 2> gain{};  // 1 + gain[0] r² + gain[1] r⁴
    double corner_sigma = 0;       // standard deviation of log gain at r = 1
};

struct LightFit {
    using Surfaces = std::map<CardSurface, double>;
    /// Log exposure by channel and frame; absent where nothing was read.
    std::array<std::vector<std::optional<double>>, 3> exposure;
    std::array<std::vector<double>, 3> exposure_sigma;
    std::array<Surfaces, 3> offset;  // log light on a surface, by channel; of no particular mean
    std::optional<Vignette> vignette;
};

/// value = exposure(frame, channel) + offset(surface, channel) + log(1 + v₁r² + v₂r⁴), solved for all by Gauss and
/// Newton with Cauchy's weights. The fall-off is the lens', one for all channels, and is told from the light on the
/// tags by tags that move across the frame; it is absent unless that tells it to a few percent in the corner.
LightFit fit_light(const std::vector<LogReading>& readings, std::size_t frame_count);

}  // namespace matchlight
