// Motion blur from one picture of the layer: light is gathered along the way that each pixel goes while the shutter is
// open.
//
// After McGuire, Hennessy, Bukowski & Osman 2012, "A Reconstruction Filter for Plausible Motion Blur", and Guertin,
// McGuire & Nowrouzezahrai 2014, "A Fast and Stable Feature-Aware Motion Blur Filter", with these deviations:
// - light is premultiplied and the plate behind it is known: where a body leaves a pixel it becomes transparent, and no
//   background has to be guessed but that of other virtual bodies;
// - a tap counts by the exact share of its smear that falls on the tap's stretch of the line, so that weights sum to 1
//   without noise and without normalisation;
// - bodies are told apart by their number, not by depth alone: a body's own slope hides nothing of it;
// - the dominant way is that of the fastest tile whose smear reaches the pixel's, in any distance.
// Ways are straight and even: what turns far within the exposure is better drawn at several times.
#pragma once

#include "gl/shader_library.h"
#include "render/composite_pass.h"
#include "render/graph.h"
#include "scene/scene_file.h"

namespace matchlight {

struct MotionBlurKnobs {
    int most_taps = 64;  // on either side of a pixel; longer ways are sampled in wider steps
};
MotionBlurKnobs motion_blur_knobs(QualityLevel level);

/// What moves, on plate pixels.
struct MotionBlurInput {
    GraphTexture light;  // RGBA32F: premultiplied radiance in probe units, a = coverage
    GraphTexture ways;   // as add_plate_ways() makes it, over the same region
    double way_px = 0;   // no way is longer
    double soft_px = 0;  // how far light may lie outside the bodies already: they are out of focus
};

/// Over `region`: xy = the way in plate pixels from the shutter's opening to its closing (0 where it is shorter than
/// least_motion_px), z = the number of the nearest body, w = 1/m. The layer of `input` has its ways.
GraphTexture add_plate_ways(RenderGraph& graph, ShaderLibrary& shaders, const CompositePass& composite,
                            const CompositeInput& input, const Region& region);

GraphTexture add_motion_blur(RenderGraph& graph, ShaderLibrary& shaders, const MotionBlurInput& input,
                             const MotionBlurKnobs& knobs);

/// The camera when the shutter opens and closes.
struct ShutterEnds {
    RigidTransform opening_camera_from_world = RigidTransform::Identity();
    RigidTransform closing_camera_from_world = RigidTransform::Identity();
};

/// The shadow on the real surface, smeared as that moves before the camera. `ratio` is add_shadow_ratio()'s, of
/// `input`; what is written covers `region`.
struct ShadowMotionInput {
    GraphTexture ratio;
    const CompositeInput& input;
    ShutterEnds ends;
    double way_px = 0;  // no way is longer
    Region region;
};
GraphTexture add_shadow_motion_blur(RenderGraph& graph, ShaderLibrary& shaders, const CompositePass& composite,
                                    const ShadowMotionInput& shadow, const MotionBlurKnobs& knobs);

}  // namespace matchlight
