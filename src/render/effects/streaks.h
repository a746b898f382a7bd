// Streak glare: bright light is drawn out into lines, as by scratches and edges before the lens.
//
// After Kawase 2003, "Frame Buffer Postprocessing Effects in DOUBLE-S.T.E.A.L": pass p adds taps at b·s texels,
// b = 4^(p−1), s = 0, 1, …, weighted a^(b·s), so that a few passes make a long exponential; divided by what the weights
// sum to. Deviations: the last pass has as many taps as the streak is long (so that its length does not depend on the
// resolution), the source's own tap counts
// about half, as the exponential has it, and slanted streaks run along rows (or columns)
// shifted by fractions of a texel, so that a tap is a single fetch and only the shifts there and back interpolate.
// The double-precision reference is report/streaks_reference.h.
#pragma once

#include "gl/shader_library.h"
#include "render/effects/streaks_model.h"
#include "render/frame_light.h"
#include "scene/scene_file.h"

namespace matchlight {

/// What trades error for time.
struct StreakKnobs {
    int largest_scale = 32;      // frame pixels along a side of a texel: a power of two
    double sigma_texels = 0.52;  // least width of a streak, as a standard deviation in texels, from 0.125
    double cut_sigmas = 3;       // where a streak's Gaussian ends on either side
    bool full_float = false;     // textures of 32 bits a channel instead of 16

    /// Throws std::invalid_argument naming what is out of range.
    void check() const;
};

StreakKnobs streak_knobs(QualityLevel quality);

/// Whose light streaks: with a glare of its own, dazzling reflection takes `objects` and the scene's glare the `rest`.
struct StreakSource {
    BrightShare share = BrightShare::all;
    double object_strength = 1;
};

/// Plate-linear light to add to the picture, signed and times its strength: its sum is that of the bright light times
/// the strength, whatever the directions, but for what leaves the frame. Level `classic` draws the study's streaks,
/// every other level these. Valid where `bright` is met; empty where nothing virtual is seen or the strength is 0.
GraphTexture add_streaks(RenderGraph& graph, ShaderLibrary& shaders, const FrameLight& light,
                         const GlareSettings& settings, const StreakKnobs& knobs, const StreakSource& source,
                         GpuCondition& bright);

}  // namespace matchlight
