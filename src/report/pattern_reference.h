// Patterns in double precision, and what a pixel sees of them, summed over many points.
#pragma once

#include <functional>

#include <Eigen/Core>

#include "scene/surface_detail.h"

namespace matchlight {

/// At a point of the pattern's space, unfiltered: what surface/patterns.glsl computes of it.
Eigen::Vector3d pattern_color(const PatternSettings& pattern, const Eigen::Vector3d& point);

/// Under a Gaussian pixel of the shader's width: the mean over `side`² points; `at(x, y)` is the point that lies so
/// many pixels aside.
Eigen::Vector3d filtered_pattern(const PatternSettings& pattern,
                                 const std::function<Eigen::Vector3d(double, double)>& at, int side);

}  // namespace matchlight
