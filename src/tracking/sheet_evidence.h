// How far corners and sheets depart from where they should be, as the clip itself shows it.
#pragma once

#include <span>

#include "tracking/shared_normal.h"

namespace matchlight {

/// Sets `corner_bias_px`, `plane_sigma_m` and which tags lie on the common plane to what makes the observations most
/// probable, all shared unknowns integrated out (type-II maximum likelihood; MacKay 1992, Bayesian Interpolation). A
/// tag is on the plane, to plane_sigma_m, or anywhere; the plane is given up when fewer than two tags are on it or no
/// place is unknown. `frames_say` holds what the frames say of `columns`, which have a plane and corner offsets.
void choose_sheet_evidence(const SharedNormal& frames_say, const SharedColumns& columns, ClipModel& model,
                           ModelFreedom& freedom);

/// The plane that most tags lie near, z up out of their faces: where the search for one starts.
RigidTransform likely_plane(const ClipModel& model);

}  // namespace matchlight
