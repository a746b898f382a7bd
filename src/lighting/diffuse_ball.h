// The energy of lamps that no photograph could hold, from a grey or white ball that they light.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "lighting/ball_probe.h"
#include "lighting/ball_view.h"
#include "lighting/clipped_parts.h"

namespace matchlight {

/// A matte ball, photographed where the mirror ball stood: with outline and pose, in the mirror ball's units.
struct DiffuseBall {
    BallView view;
    std::optional<Eigen::Vector3d> albedo;  // absent: told by the parts of the ball that no clipped light reaches
};

/// Solves the energies of the clipped lights of `probe` from the ball's shading, and multiplies their pixels by the
/// gains (Debevec, Tchou, Gardner et al. 2003, "Estimating Surface Reflectance Properties of a Complex Scene under
/// Captured Natural Illumination", section 3.2). Each patch of the ball, of some 1,200, is one equation of
/// solve_gains(); its normal follows from the outline, so that the ball's radius need not be known. It is taken to be
/// Lambertian; light from below, which the ball itself darkens where it stands, counts as half known. The rim is left
/// out. Returns the lights, brightest bound first; none where nothing is clipped. Throws InputError naming the view
/// where fewer than 50 patches can be read: small, dark, or clipped itself.
std::vector<ClippedLight> solve_clipped_lights(BallProbe& probe, const DiffuseBall& ball);

}  // namespace matchlight
