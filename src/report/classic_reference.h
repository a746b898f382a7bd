// Classic shading in double precision: a reference for shaders/surface/classic.glsl.
#pragma once

#include <span>

#include <Eigen/Core>

#include "scene/classic_shading.h"

namespace matchlight {

/// A lamp as a point sees it, past whatever stands between.
struct ClassicLamp {
    Eigen::Vector3d to_lamp = Eigen::Vector3d::UnitZ();  // unit
    Eigen::Vector3d irradiance = Eigen::Vector3d::Zero();
};

struct ClassicPoint {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ(), to_eye = Eigen::Vector3d::UnitZ();   // unit
    Eigen::Vector3d diffuse = Eigen::Vector3d::Ones(), specular = Eigen::Vector3d::Zero();  // Od, Ks
    Eigen::Vector3d ambient = Eigen::Vector3d::Zero();                                      // irradiance over π
};

/// Phong 1975, Blinn 1977, Lake et al. 2000 (cartoon), Gooch et al. 1998; of a physical model, none.
Eigen::Vector3d classic_reference(const ClassicShading& shading, const ClassicPoint& point,
                                  std::span<const ClassicLamp> lamps);

}  // namespace matchlight
