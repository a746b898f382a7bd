// Bloom: bright light spreads around where it is, as lens and sensor scatter it.
//
// The model is a mixture of Gaussians (bloom_model.h) over the light of the bright pass. `pyramid` reaches each on the
// first level of a pyramid whose texels are fine enough for it: reduced by [1 3 3 1]/8, blurred by what its variance
// still wants, and magnified by [1 3 3 1]/4 (Burt & Adelson 1983, "The Laplacian Pyramid as a Compact Image Code"; both
// steps are quadratic B-splines in the limit), of which every variance is accounted for. `reference` is the same with
// very fine levels, in full float. `classic` is the study's chain of squares (bloom_classic.h). The double-precision
// reference of each is report/bloom_reference.h.
#pragma once

#include "gl/shader_library.h"
#include "render/effects/bloom_model.h"
#include "render/frame_light.h"
#include "scene/scene_file.h"

namespace matchlight {

/// What trades error for time.
struct BloomKnobs {
    int largest_scale = 8;       // frame pixels along a side of the bright pass' texel: 1, 2, 4, 8
    double sigma_texels = 0.85;  // least width of a Gaussian in texels of its level, from 0.75
    double cut_sigmas = 3;       // where blurs end, and how far light is followed at all
    int gaussians = 5;           // of the model's five: the narrowest left out pass their weight to the next
    bool full_float = false;     // textures of 32 bits a channel instead of 16

    /// Throws std::invalid_argument naming what is out of range.
    void check() const;
};

/// The level that a quality stands for, unless the scene's settings say another.
BloomKnobs bloom_knobs(const BloomSettings& settings, QualityLevel quality);

/// Plate-linear light to add to the picture, signed and times its strength: bright light spread about, so an object
/// that hides a lamp takes the lamp's bloom along. Sum and strength of what comes in are kept but for what leaves the
/// frame or reaches beyond knobs.cut_sigmas of the widest Gaussian (0.3 % at 3). Valid where `bright` is met; empty
/// where nothing virtual is seen or the strength is 0.
GraphTexture add_bloom(RenderGraph& graph, ShaderLibrary& shaders, const FrameLight& light,
                       const BloomSettings& settings, const BloomKnobs& knobs, double object_strength,
                       GpuCondition& bright);

}  // namespace matchlight
