// The double-precision reference of diffraction: the same pattern, converged, at the frame's own resolution.
#pragma once

#include "core/image.h"
#include "render/effects/diffraction.h"

namespace matchlight {

/// Knobs at which the pattern has converged.
inline constexpr DiffractionQuality converged_diffraction{.aperture_side = 2048, .wavelengths = 128, .samples = 2};

/// The light that diffraction adds to a frame, strength included; `bright_light` is D of the bright pass for every
/// pixel, RGB, signed.
Image<double> reference_diffraction(const Image<double>& bright_light, const GlareSettings& settings,
                                    const DiffractionQuality& quality = converged_diffraction);

}  // namespace matchlight
