// What the camera's sensor does to virtual light in a frame, as the scene asks for it and the solve knows it.
#pragma once

#include <array>
#include <optional>

#include "core/warnings.h"
#include "render/effects/chromatic_aberration.h"
#include "render/effects/grain.h"
#include "scene/effects.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// Of the settings where they say, else of the solve. nullopt, and a warning, where neither knows the noise. Where the
/// whole picture is exposed anew, `plate_gain` scales the plate's noise, and so the model.
std::optional<GrainModel> grain_of_frame(const GrainSettings& settings, const Solve& solve, std::int64_t frame,
                                         double plate_gain, Warnings& warnings);

/// Nothing, and a warning, where the settings say nothing: the solve does not measure it.
std::optional<LateralColor> lateral_color_of(const ChromaticAberrationSettings& settings, const Solve& solve,
                                             Warnings& warnings);

/// Standard deviation in plate pixels: of the settings, else of the solve; 0 where neither knows it.
double softness_px_of(const SoftnessSettings& settings, const Solve& solve, Warnings& warnings);

/// The lens' fall-off, gain = 1 + v0 r² + v1 r⁴: none without settings.
std::array<double, 2> vignette_of(const std::optional<VignetteSettings>& settings, const Solve& solve);

}  // namespace matchlight
