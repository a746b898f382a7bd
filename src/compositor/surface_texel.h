// One texel of the real surface, from what several frames say of it.
#pragma once

#include <array>
#include <span>

#include "compositor/surface_frames.h"

namespace matchlight {

struct SurfaceTexel {
    std::array<double, 3> radiance{};
    double knowledge = 0;  // 0 to 1: how many of the frames, by weight, agree
    bool clipped = false;  // some channel is known only from below
};

/// The weighted mean of the frames that agree with the weighted median: what passes over the surface in fewer of them
/// is left out, and where there is no majority little is known. A clipped channel is a bound that the light should not
/// lie below, and stands for it where no frame says more. No samples: unknown.
SurfaceTexel agreed_texel(std::span<const SurfaceSample> samples);

}  // namespace matchlight
