// Double-precision references of the shadows: a ray for each of many directions of light, at every point anew.
//
// They hold the same model as render/effects/contact_shadow.h and object_shadow.h (light at infinity, the surface's
// light returned by what stands over it) without its maps, grids and biases. report/contact_shadow_reference.h is
// plainer still: every pixel of the probe, and nothing returned.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "lighting/probe.h"
#include "scene/ray_caster.h"

namespace matchlight {

/// The real surface's light, as render/effects/contact_shadow.h has it.
struct ReferenceSurface {
    double z_m = 0;
    std::vector<DirectionalSample> samples;  // of the light from above
    double radiance_per_irradiance = 0;      // sent back of the light, 1/sr
};

/// The share of the surface's light that is left at points of it.
class ContactShadowReference {
public:
    /// `reflectance` of each mesh of the casters; both must outlive this.
    ContactShadowReference(const ReferenceSurface& surface, const RayCaster& casters,
                           std::span<const double> reflectance);

    Eigen::Vector3d ratio(const Eigen::Vector2d& surface_m) const;

private:
    struct Light {
        Eigen::Vector3d direction, share;
        double returned = 0;
    };
    std::vector<Light> lights_;
    const RayCaster& casters_;
    std::span<const double> reflectance_;
    double z_m_;
};

/// What light a point of an object gets over its hemisphere, as a share of the unshadowed.
struct VertexShadowReference {
    const std::vector<DirectionalSample>& samples;  // over the whole sphere
    const RayCaster& casters;
    /// What is left of the light that comes up from the surface, from where a ray meets it: 1 without a surface.
    std::function<double(const Eigen::Vector3d& position_m, const Eigen::Vector3d& direction)> left_along;
    /// Facets nearer than that are the vertex's own.
    double own_facets_m = 0;

    Eigen::Vector3d visibility(const Eigen::Vector3d& position_m, const Eigen::Vector3d& normal) const;
};

}  // namespace matchlight
