// What the covered shares of pixels at the edges of spheres and levels of detail cost, and how far they are off.
#pragma once

#include "report/report.h"
#include "report/run_time.h"
#include "report/sphere_reference.h"
#include "report/sphere_stage.h"

namespace matchlight {

struct SphereTrialView {
    ReferenceView view;
    TimingOptions timing;
    bool quick = false;  // compares fewer pixels
};

/// Against the mean of 16×16 rays a pixel. `stage` has one opaque set; `rays` the same. They lack their names.
/// Places at edges, and whole pictures of more pixels instead.
EffectReport measure_sphere_edges(SphereStage& stage, const SphereCaster& rays, const SphereTrialView& view);
/// Fewer and larger spheres in place of those that are smaller than so much of a pixel.
EffectReport measure_sphere_detail(SphereStage& stage, const SphereCaster& rays, const SphereTrialView& view);

}  // namespace matchlight
