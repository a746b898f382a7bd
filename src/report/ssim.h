// Structural similarity: Wang, Bovik, Sheikh, Simoncelli, "Image Quality Assessment: From Error Visibility to
// Structural Similarity", IEEE Transactions on Image Processing 13(4), 2004.
#pragma once

#include <optional>

#include "core/image.h"

namespace matchlight {

/// The side of the window; images must be at least as large.
constexpr int ssim_window_px = 11;

/// Mean SSIM of the luma (BT.601 weights, unrounded) of two 8-bit R'G'B' images with the authors' parameters: Gaussian
/// window of 11 × 11 with a deviation of 1.5 pixels, K1 = .01, K2 = .03, L = 255, taken wherever the window lies inside
/// the image. A mask (may be nullptr) selects by the window's centre. nullopt where none is selected.
std::optional<double> ssim(const Image8& reference, const Image8& test, const Image8* mask = nullptr);

}  // namespace matchlight
