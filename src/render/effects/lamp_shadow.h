// What analytic lights do to the real surface: those of the footage lose what objects take of them, virtual ones are
// added.
//
// The picture of the surface is multiplied by the light that falls on it with objects and lamps over the light that it
// was filmed in, the probe's and that of the lamps that are the footage's own: the surface's colour needs no guessing
// (Debevec 1998, "Rendering Synthetic Objects into Real Scenes"). A lamp's light is evaluated where it is looked up
// (effects/contact_shadow/contact_shadow.glsl); the maps of the contact shadow hold what casters take of it, flattened
// onto the surface from points of the lamp. The double-precision reference is report/lamp_reference.h.
#pragma once

#include <optional>

#include "render/effects/contact_shadow.h"
#include "render/lamps.h"

namespace matchlight {

/// The rectangle of the surface in which casters take more than `lost_share` of some lamp's light; empty where none
/// does.
Eigen::AlignedBox2d lamp_shadow_reach(const Eigen::AlignedBox3d& caster_bounds_m, double surface_z_m,
                                      const SurfaceLamps& lamps, double lost_share);

/// The probe's shadow with that of the lamps; `of_probe` was made with lamp_shadow_reach(), or is nullopt where nothing
/// casts. A lamp that is no point is taken as `points` of them. Nullopt where no lamp falls on the surface and there
/// was none.
std::optional<ContactShadow> with_lamps(ShaderLibrary& shaders, std::optional<ContactShadow> of_probe,
                                        const ShadowCasters& casters, double surface_z_m, const SurfaceLamps& lamps,
                                        int points);

}  // namespace matchlight
