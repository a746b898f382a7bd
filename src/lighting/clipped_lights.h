// The energy of lamps that no photograph could hold, from the paper that they light.
#pragma once

#include <vector>

#include "lighting/ball_fit.h"
#include "lighting/ball_probe.h"
#include "lighting/ball_rig.h"
#include "lighting/clipped_parts.h"

namespace matchlight {

/// Solves the energies of the clipped lights of `probe` from the light of the white cells of the tags, and multiplies
/// their pixels by the gains (after Debevec, Tchou, Gardner et al. 2003, "Estimating Surface Reflectance Properties of
/// a Complex Scene under Captured Natural Illumination", which takes a diffuse ball). Each white cell is one equation,
///     radiance = albedo / π · (irradiance of the rest + Σ gain · irradiance of each clipped light),
/// the ball's shadow in both: it parts the lights from each other and from the albedo, which is one for all cells and
/// known within 5 %. `scene` has a plane and a rig. A gain is 1 at least. Lights smaller than a ten-thousandth of the
/// rest's irradiance are left as they are. Returns the lights, brightest bound first.
std::vector<ClippedLight> solve_clipped_lights(BallProbe& probe, const BallScene& scene, double white_albedo);

}  // namespace matchlight
