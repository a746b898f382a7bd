// The lens' opening: which points of it light passes, and the shape that out-of-focus points take.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "scene/effects.h"

namespace matchlight {

/// Distance of a point from the middle of the opening such that the opening is all that is at most 1 away: the circle
/// through a polygon's corners has radius 1. x to the right and y downwards in the picture, as light from beyond the
/// focus shows the opening; before the focus it is seen turned by 180°.
double bokeh_distance(const BokehSettings& bokeh, const Eigen::Vector2d& point);

/// Area of the opening; π where it is round.
double bokeh_area(const BokehSettings& bokeh);

/// `count` points evenly over the opening. Round: Vogel's spiral (Vogel 1979, "A better way to construct the sunflower
/// head"); else those of the R2 sequence (Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences") that
/// fall inside. Their mean is moved to the middle, so that nothing shifts.
std::vector<Eigen::Vector2d> lens_points(const BokehSettings& bokeh, int count);

}  // namespace matchlight
