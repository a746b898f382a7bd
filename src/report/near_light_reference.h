// What points and lobes see of what is near, in double precision: the truth that rays on the GPU are held against.
#pragma once

#include <functional>

#include <Eigen/Core>

namespace matchlight {

/// Light that arrives along a direction (world, unit length) at the point that is looked from.
using SeenAlong = std::function<Eigen::Vector3d(const Eigen::Vector3d& direction)>;

/// A GGX surface and the eye that looks at it.
struct LobeView {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    Eigen::Vector3d towards_eye = Eigen::Vector3d::UnitZ();
    double roughness = 0;    // perceptual
    double reflectance = 1;  // of light that falls straight on: Schlick's beyond
};

/// What the surface mirrors to the eye at its facets' first meeting with light: strata² facets, spread as they are by
/// Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces" (eq. 35 and 36), with the masking of
/// Heitz 2014. It samples otherwise than the shaders do (visible facets alone, over the sum of their weights).
Eigen::Vector3d reference_mirrored(const LobeView& lobe, int strata, const SeenAlong& seen);

/// Irradiance over π: strata² directions spread as the cosine.
Eigen::Vector3d reference_gathered(const Eigen::Vector3d& normal, int strata, const SeenAlong& seen);

}  // namespace matchlight
