// The place where two edges of a board cross, to hundredths of a pixel.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/image.h"

namespace matchlight {

/// Where to look and how the board lies there.
struct SaddleGuess {
    Eigen::Vector2d px;
    Eigen::Matrix2d px_from_board;  // columns: pixels for a metre along the board's two axes
    double radius_m = 0;            // half the side of the part of the board that is looked at
};

struct Saddle {
    Eigen::Vector2d px;
    double sigma_px = 0;  // of either coordinate, from what the fit leaves over
    double blur_px = 0;   // standard deviation of the edges' blur
    double contrast = 0;  // of light between the two colours
    double residual = 0;  // root mean square of what the fit leaves over, over the contrast
};

/// Fits two blurred edges that cross to linear light: L = a + g·(x − c) + b·erf(d₁/(√2 s))·erf(d₂/(√2 s)), with d the
/// distances from the edges. Exact for edges at right angles under Gaussian blur, and symmetric about c for all others.
/// nullopt where there is no such crossing within half the radius of the guess.
std::optional<Saddle> fit_saddle(const ImageF& light, const SaddleGuess& guess);

}  // namespace matchlight
