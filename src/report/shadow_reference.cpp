// Sums over directions of light.
#include "report/shadow_reference.h"

#include <algorithm>
#include <cassert>

namespace matchlight {

ContactShadowReference::ContactShadowReference(const ReferenceSurface& surface, const RayCaster& casters,
                                               std::span<const double> reflectance)
    : casters_(casters), reflectance_(reflectance), z_m_(surface.z_m) {
    Eigen::Vector3d total = Eigen::Vector3d::Zero();
    for (const DirectionalSample& sample : surface.samples) {
        total += sample.radiance_times_solid_angle * std::max(sample.direction.z(), 0.0);
    }
    for (const DirectionalSample& sample : surface.samples) {
        const double cosine = sample.direction.z();
        if (cosine <= 0) continue;
        const Eigen::Vector3d light = sample.radiance_times_solid_angle * cosine;
        lights_.push_back({sample.direction, light.cwiseQuotient(total.cwiseMax(1e-300)),
                           surface.radiance_per_irradiance * sample.solid_angle_sr * cosine});
    }
}

Eigen::Vector3d ContactShadowReference::ratio(const Eigen::Vector2d& surface_m) const {
    const Eigen::Vector3d point(surface_m.x(), surface_m.y(), z_m_);
    Eigen::Vector3d lost = Eigen::Vector3d::Zero();
    double returned = 0;
    for (const Light& light : lights_) {
        const auto hit = casters_.nearest(point, light.direction, 0);
        if (!hit) continue;
        lost += light.share;
        returned += light.returned * std::clamp(reflectance_[static_cast<std::size_t>(hit->mesh)], 0.0, 1.0);
    }
    // As effects/contact_shadow/contact_shadow.glsl: r = open + returned · r.
    const Eigen::Vector3d left = (Eigen::Vector3d::Ones() - lost) / std::max(1 - returned, 0.1);
    return left.cwiseMax(0).cwiseMin(1);
}

Eigen::Vector3d VertexShadowReference::visibility(const Eigen::Vector3d& position_m,
                                                  const Eigen::Vector3d& normal) const {
    Eigen::Vector3d open = Eigen::Vector3d::Zero(), all = Eigen::Vector3d::Zero();
    for (const DirectionalSample& sample : samples) {
        const double cosine = normal.dot(sample.direction);
        if (cosine <= 0) continue;
        const Eigen::Vector3d light = sample.radiance_times_solid_angle * cosine;
        all += light;
        if (casters.nearest(position_m, sample.direction, own_facets_m)) continue;
        open += light * left_along(position_m, sample.direction);
    }
    Eigen::Vector3d share = Eigen::Vector3d::Ones();
    for (int c = 0; c < 3; ++c) {
        if (all[c] > 0) share[c] = open[c] / all[c];
    }
    return share;
}

}  // namespace matchlight
