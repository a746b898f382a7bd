// The part of the split-sum approximation that does not depend on the light.
#pragma once

#include <Eigen/Core>

#include "core/image.h"

namespace matchlight {

/// Directional albedo of a GGX microfacet surface as scale·F0 + bias (Karis 2013, "Real Shading in Unreal Engine 4"),
/// with Schlick's Fresnel term and height-correlated Smith masking (Heitz 2014), single scattering. `roughness` is
/// perceptual: alpha = roughness². Integrated over `samples` visible normals (Heitz 2018).
Eigen::Vector2d split_sum(double n_dot_v, double roughness, int samples);

/// Two channels (scale, bias); columns are n·v, rows roughness, both at texel centres of [0, 1].
ImageF split_sum_table(int size, int samples);

}  // namespace matchlight
