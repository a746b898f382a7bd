// The soft shadow that virtual objects cast on the real surface: how much of the probe's light still arrives there.
//
// On the plate a shadow is a ratio, light with the objects over light without, per channel; the surface's colour needs
// no guessing (differential rendering: Debevec 1998, "Rendering Synthetic Objects into Real Scenes"). The light is
// split into directions of about equal power (Debevec 2005, "A Median Cut Algorithm for Light Probe Sampling"); along
// each, the casters are flattened onto the surface (Blinn 1988, "Me and My (Fake) Shadow"), which needs no bias and
// leaves no gap at the contact. Its double-precision reference is report/contact_shadow_reference.h.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "gl/objects.h"
#include "gl/program.h"
#include "gl/shader_library.h"
#include "lighting/probe.h"
#include "render/sphere_sets.h"

namespace matchlight {

struct ContactShadowSettings {
    int directions = 128;   // strata of light, 1..1024
    int resolution = 1024;  // texels along the longer side of each map, 16..4096
    /// Where the shadow is cut off: the share of the surface's light that may be lost unseen beyond the far map's edge.
    /// 0.002 of the light is less than half a code of 8 bits everywhere on the sRGB curve.
    double lost_share = 0.002;

    /// Throws std::invalid_argument naming the value that is out of range.
    void check() const;
};

/// The geometry that casts: all of it lies in `bounds_m`; `draw` draws it with the given program (positions at
/// attribute 0, uniform `world_from_model` set for each object).
struct ShadowCasters {
    Eigen::AlignedBox3d bounds_m;
    std::function<void(Program&)> draw;
    std::function<void(const SphereCast&)> cast_spheres = {};  // the spheres among them; empty where there are none
};

/// What the casters take away of the surface's light (RGB share) and return of it (alpha), over a rectangle of the
/// surface (world x, y); row 0 holds the smallest y.
struct ShadowMap {
    Texture2D loss;  // RGBA32F
    Eigen::AlignedBox2d rectangle_m;
};

/// Along the light onto the map, as effects/contact_shadow/flatten.vert does it; depth ½ is the surface, more lies
/// above it.
SphereProjection flattening_view(const Eigen::Vector3d& to_light, double surface_z_m, double highest_m,
                                 const ShadowMap& map);

/// Marked cells of a grid over a part of the surface.
class SurfaceCells {
public:
    explicit SurfaceCells(const Eigen::AlignedBox2d& rectangle_m);

    void mark(const Eigen::AlignedBox2d& box_m);
    /// Of the cells marked so far.
    void sum_up();
    /// Whether a box holds a part of a cell that was marked.
    bool any_in(const Eigen::AlignedBox2d& box_m) const;
    Eigen::Vector2d cell_m() const { return rectangle_m_.sizes() / cells; }

private:
    static constexpr int cells = 256;  // along each side
    Eigen::Array2i cell_of(const Eigen::Vector2d& point_m) const;

    Eigen::AlignedBox2d rectangle_m_;
    std::vector<std::int32_t> sums_;  // of marked cells above and to the left; (cells + 1)²
};

/// Where a shadow lies, on the CPU: which cells of a grid over the surface lose more of their light than a limit.
class ShadowFootprint {
public:
    ShadowFootprint(const ShadowMap& far, const ShadowMap& fine, double least_loss);

    /// Whether the shadow can be seen anywhere in a box of the surface.
    bool touches(const Eigen::AlignedBox2d& box_m) const { return cells_.any_in(box_m); }

private:
    SurfaceCells cells_;
};

/// Where a shadow has edges: elsewhere its share of the light, taken at points no farther apart than smooth_over_m(),
/// is linear between them to an eighth of `least_bend`.
class ShadowDetail {
public:
    ShadowDetail(const ShadowMap& far, const ShadowMap& fine, double least_bend);

    bool touches(const Eigen::AlignedBox2d& box_m) const { return cells_.any_in(box_m); }
    double smooth_over_m() const { return cells_.cell_m().minCoeff(); }

private:
    SurfaceCells cells_;
};

class Lamps;

/// Analytic lights that fall on the surface beside the probe's.
struct SurfaceLamps {
    const Lamps* lamps = nullptr;  // outlives it
    Eigen::Vector3d probe_irradiance = Eigen::Vector3d::Zero();

    /// What the maps' shares are shares of: the probe's light or, in channels where it has none, 1.
    Eigen::Vector3d reference() const;
    /// Whether virtual lamps may bring a part of the surface more than `least_share` of the probe's light.
    bool light(const Eigen::AlignedBox2d& box_m, double surface_z_m, double least_share) const;
};

/// The whole shadow is the sum of two maps: the fine map holds the steep directions' shadows, close around the casters'
/// feet, the far map the flat ones', as far as they reach.
struct ContactShadow {
    ShadowMap fine, far;
    double surface_z_m = 0;
    std::optional<SurfaceLamps> lamps = {};  // then shaders are compiled with LAMPS

    /// Sets the uniforms of effects/contact_shadow/contact_shadow.glsl; takes texture units `first_unit` and the next.
    void bind(Program& program, GLuint first_unit) const;
    /// What shaders that include contact_shadow.glsl are compiled with for it.
    ShaderDefines defines() const { return lamps ? ShaderDefines{{"LAMPS", "1"}} : ShaderDefines{}; }
    /// Another with the same contents.
    ContactShadow copy() const;
};

/// The real surface and its light.
struct SurfaceLight {
    double z_m = 0;
    std::vector<DirectionalSample> samples;  // of the hemisphere above it
    /// What it sends back of its light, unshadowed, luminance over that of its irradiance (1/sr): its albedo over π, as
    /// the probe sees it from above. Casters return a part of it; 0 makes them black.
    double radiance_per_irradiance = 0;
    Eigen::AlignedBox2d lamp_reach_m = {};  // where shadows of analytic lights fall: the maps hold it, too
};
/// From a placed probe: the light from above in `directions` strata, and the lower half as the surface's radiance.
SurfaceLight make_surface_light(const Probe& probe, double z_m, int directions);

/// The shadow of `casters` on the surface, drawn once: static casters under static light need no other. Nullopt where
/// no caster rises above the surface or no light comes from above: there the ratio is 1 by definition.
std::optional<ContactShadow> make_contact_shadow(ShaderLibrary& shaders, const ShadowCasters& casters,
                                                 const SurfaceLight& surface, const ContactShadowSettings& settings);

/// The rectangle of the surface outside which the casters block less than `lost_share` of its light.
Eigen::AlignedBox2d contact_shadow_reach(const Eigen::AlignedBox3d& caster_bounds_m, double surface_z_m,
                                         const std::vector<DirectionalSample>& samples, double lost_share);

}  // namespace matchlight
