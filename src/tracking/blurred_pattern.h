// What a tag's printed cells look like through pixels and blur, in closed form.
#pragma once

#include <cstddef>
#include <vector>

#include "calibration/tag_family.h"

namespace matchlight {

/// How one pixel sees the grid along one axis of it: the width of the pixel's footprint and the standard deviation of
/// the blur, both in cells.
struct AxisFootprint {
    double pixel_width = 0;
    double blur = 0;
};

/// Share of paper (0 = ink, 1 = paper) that a pixel sees, and its derivatives.
struct PatternSample {
    double paper = 0;
    double by_a = 0, by_b = 0;            // per cell
    double by_blur_a = 0, by_blur_b = 0;  // per cell of blur
    double by_covariance = 0;             // per square cell
};

/// A tag's cells convolved with a box (the pixel) and a Gaussian (lens, motion). Along the tag's two axes the blur is
/// exact, and so is every straight edge whatever the tilt; that the blur may lie aslant to the axes shows at the
/// corners of cells only and is kept to first order: d/dΣ_ab of a Gaussian blur is ∂²/∂a∂b.
class BlurredPattern {
public:
    explicit BlurredPattern(const TagPattern& pattern);

    int cells() const { return cells_; }
    /// At grid point (a, b): a to the right of the sheet, b down it, in cells. Beyond the grid, and in cells without
    /// ink of their own, the nearest known cell goes on.
    /// `covariance` (square cells) is that of the blur, pixel included, between the axes.
    PatternSample at(double a, double b, const AxisFootprint& along_a, const AxisFootprint& along_b,
                     double covariance) const;

    /// Whether a point lies at least half a cell away from everything the pattern does not tell.
    bool is_known(double a, double b) const;
    /// Distance in cells along the axes to the nearest line where ink meets paper, no more than 1.
    double distance_to_edge(double a, double b) const;

private:
    double ink_at(int x, int y) const { return ink_[static_cast<std::size_t>(y) * cells_ + x]; }

    int cells_ = 0;
    std::vector<double> ink_;         // unknown cells filled
    std::vector<char> known_halves_;  // on a grid of half cells
};

}  // namespace matchlight
