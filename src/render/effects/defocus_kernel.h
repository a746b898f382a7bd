// Out-of-focus discs on a grid of texels: which texels they cover, and how much of their light each takes.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/image.h"
#include "scene/effects.h"

namespace matchlight {

/// A texel that a disc may reach, seen from its middle.
struct DiscTap {
    Eigen::Vector2i offset;
    double distance =
        0;  // bokeh_distance of the offset: the disc of radius r covers it by clamp(r + ½ − distance, 0, 1)
};

/// All offsets whose distance is at most `radius` + ½, nearest first. `inverted`: as light from before the focus shows
/// the opening.
std::vector<DiscTap> disc_taps(const BokehSettings& bokeh, double radius, bool inverted);

/// The mean over the opening of half its squared distance from the middle: variance along an axis of a disc of radius
/// 1. A quarter where it is round.
double bokeh_variance(const BokehSettings& bokeh);

/// How a disc of a given radius is drawn.
struct DrawnDisc {
    double radius = 0;  // of the covered texels
    double texels = 1;  // that they add up to
};
/// The drawn disc has the variance, along the axes on average, of the disc asked for less `variance_had`, which
/// resampling adds besides (texels²): small discs on a grid are otherwise too narrow or too wide.
DrawnDisc drawn_disc(const std::vector<DiscTap>& taps, double wanted_variance);

/// One row a level of resampling (0: none; k: down to texels of 2^k and up again), entries at radii of
/// 0, step, 2·step … texels: radius of the drawn disc, and how many texels it adds up to, which grow with that radius
/// in proportion but for the steps at which a ring of texels begins.
ImageF disc_table(const BokehSettings& bokeh, double largest_radius, double step, int rows);

}  // namespace matchlight
