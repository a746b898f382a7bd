// What the covered shares of pixels at the edges of spheres cost, and how far they are off.
#pragma once

#include "report/report.h"
#include "report/run_time.h"
#include "report/sphere_reference.h"
#include "report/sphere_stage.h"

namespace matchlight {

/// Places at edges, and whole pictures of more pixels instead, against the mean of 16×16 rays a pixel. `stage` has one
/// opaque set; `rays` the same. Lacks its name.
EffectReport measure_sphere_edges(SphereStage& stage, const SphereCaster& rays, const ReferenceView& view,
                                  const TimingOptions& timing, bool quick);

}  // namespace matchlight
