// Light that objects send to each other, to the rest of themselves and to the real surface: colours bleed, cavities
// brighten, what glows lights the table.
//
// At every vertex and at points of the surface rays look over the hemisphere (render/ray_scene.h); what they meet sends
// the diffuse light that arrived there, one bounce after the other, and mirrors on (Cohen & Greenberg 1985, "The
// Hemi-Cube", gathers radiosity the same way). What the rays miss is the probe's light, which is known without them.
#pragma once

#include <functional>

#include <Eigen/Geometry>

#include "gl/shader_library.h"
#include "render/effects/contact_shadow.h"
#include "render/ray_scene.h"
#include "render/surface.h"

namespace matchlight {

struct BounceLightSettings {
    int rays = 64;              // a vertex, 1..4096; 0 = no light bounces
    int surface_rays = 256;     // a point of the surface, 1..4096
    int most_rays = 4'000'000;  // a bounce over all vertices: dense meshes cast fewer each, but 4 at least
    int bounces = 3;            // from diffuse surface to diffuse surface, and mirrors between them, 1..16
    int surface_points = 96;    // along the longer side of the lit rectangle, 2..1024

    /// Throws std::invalid_argument naming the value that is out of range.
    void check() const;
};

/// Objects with their direct light, and what binds the probe's light for shaders (common/environment.glsl,
/// common/visibility.glsl).
struct BouncingObjects {
    SurfaceRenderer& surfaces;
    RayScene& rays;
    std::function<void(Program&)> bind_light;
    bool has_visibility = false;  // baked at the vertices
    ShaderDefines defines = {};   // that the shadow on the surface asks for
};

/// Fills the light at the vertices of `rays`.
void bounce_between_objects(ShaderLibrary& shaders, const BouncingObjects& objects,
                            const BounceLightSettings& settings);

/// Adds what bounces to the real surface, in place of the estimate that `shadow` holds of it. `irradiance` is the
/// surface's own from above, RGB. Within `lit_m`, which the far map holds.
void bounce_to_surface(ShaderLibrary& shaders, const BouncingObjects& objects, ContactShadow& shadow,
                       const Eigen::AlignedBox2d& lit_m, const Eigen::Vector3d& irradiance,
                       const BounceLightSettings& settings);

/// Where the light that objects send to the surface is gathered: as far around them as they are wide and high.
Eigen::AlignedBox2d bounce_reach(const Eigen::AlignedBox3d& caster_bounds_m, double surface_z_m);

}  // namespace matchlight
