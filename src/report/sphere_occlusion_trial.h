// What the light between spheres costs by more and more directions, and how far it is off.
#pragma once

#include "report/report.h"
#include "report/sphere_edge_trial.h"
#include "report/sphere_stage.h"
#include "report/sphere_trial.h"

namespace matchlight {

/// Ways to light a frame from 6 to 1,026 directions (quick: 66) whose maps are there, after one with none.
SpherePart occlusion_part(SphereStage& stage, bool quick);

/// Maps of 6 to 1,026 directions and of two sizes, against rays in double precision at pixels' middles. `stage` has one
/// opaque set; `rays` the same. The report lacks its name.
EffectReport measure_sphere_occlusion(SphereStage& stage, const SphereCaster& rays, const SphereTrialView& view);

}  // namespace matchlight
