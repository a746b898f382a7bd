// Plain error measures between two images of one size, over all pixels or those of a mask.
#pragma once

#include <optional>

#include "core/image.h"

namespace matchlight {

/// Peak signal-to-noise ratios end here: images that do not differ have it, and differences too small for an 8-bit
/// picture to show are not told apart.
constexpr double psnr_cap_db = 99;

/// Of 8-bit codes, over all channels together, capped at psnr_cap_db. A mask (1 channel, non-zero = counted) may be
/// nullptr. nullopt where no pixel is counted.
std::optional<double> psnr_db(const Image8& reference, const Image8& test, const Image8* mask = nullptr);

/// sqrt(Σ (test − reference)² / Σ reference²) over all channels of linear light; nullopt where no pixel is counted or
/// the reference is black there. Non-finite samples must have been repaired.
std::optional<double> relative_rms(const ImageF& reference, const ImageF& test, const Image8* mask = nullptr);

/// Mean of a 1-channel map over the mask; nullopt where no pixel is counted. Summed row by row in double precision.
std::optional<double> masked_mean(const ImageF& map, const Image8* mask = nullptr);

/// 255 where the mask is 0, 0 elsewhere.
Image8 inverted_mask(const Image8& mask);

/// The share of pixels that are inside, 0..1.
double mask_share(const Image8& mask);

}  // namespace matchlight
