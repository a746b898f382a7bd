// What halos cost by how many places they are looked for at, and how far they are off.
#pragma once

#include "report/report.h"
#include "report/sphere_edge_trial.h"
#include "report/sphere_stage.h"

namespace matchlight {

/// Against every pixel around in double precision. `stage` has one opaque set; `rays` the same. The report lacks its
/// name.
EffectReport measure_sphere_halos(SphereStage& stage, const SphereCaster& rays, const SphereTrialView& view);

}  // namespace matchlight
