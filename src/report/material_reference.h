// What a glTF material sends to the eye, integrated over the hemisphere in double precision: a reference for
// shaders/surface/surface.frag.
#pragma once

#include <functional>

#include <Eigen/Core>

#include "scene/model.h"

namespace matchlight {

/// A point of a surface.
struct ReferencePoint {
    Eigen::Matrix3d world_from_surface = Eigen::Matrix3d::Identity();  // columns: tangent, bitangent, normal
    Eigen::Vector3d to_eye = Eigen::Vector3d::UnitZ();                 // unit, world
};

using RadianceFrom = std::function<Eigen::Vector3d(const Eigen::Vector3d& direction)>;

/// The radiance of the factors of `material`, without its textures and emission: GGX with Smith's masking (Heitz 2014),
/// stretched by the anisotropy, Schlick's Fresnel term, what meets the facets more than once as if diffuse (Fdez-Agüera
/// 2019), Lambert below or, where it transmits, what is behind a thin wall, sheen and coat above, each over `samples`
/// directions of its own distribution.
Eigen::Vector3d material_reference(const ModelMaterial& material, const ReferencePoint& point,
                                   const RadianceFrom& radiance, int samples);

}  // namespace matchlight
