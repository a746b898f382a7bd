// The double-precision reference of the thin lens: even rectangles that face the camera, seen through every part of the
// opening.
//
// Seen from another point of the lens a rectangle's picture only moves, by its circle of confusion: so a pixel's mean
// over its own area is exact, edges and partly hidden cards included, and only the mean over the opening is a sum.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "calibration/thin_lens.h"
#include "report/bright_reference.h"
#include "scene/effects.h"

namespace matchlight {

/// In pixels as a pinhole at the lens' middle shows it, pixel centres at whole numbers.
struct LensCard {
    double left_px = 0, top_px = 0, right_px = 0, bottom_px = 0;
    double depth_m = 1;
    Eigen::Vector4d light = Eigen::Vector4d::Ones();  // premultiplied, a = coverage
};

struct ThinLensView {
    int width = 0, height = 0;
    Focus focus;
    BokehSettings bokeh;
    std::vector<LensCard> cards;
    int lens_steps = 64;  // along a side of the square around the opening
};

/// RGBA, premultiplied, of all cards over nothing. All cores; the same bits on any number of them.
ImageD thin_lens_light(const ThinLensView& view);

/// What becomes of one evenly lit pixel's light under a circle of confusion.
struct SpreadPixel {
    double moved_share = 0;   // of the light that leaves the pixel
    double beside_share = 0;  // the most that one other pixel gets
};
SpreadPixel spread_pixel(double coc_px);

/// The share of a disc, of diameter 1 about 0, that lies on the side of a straight edge where x < `edge`.
double disc_share_before(double edge);

}  // namespace matchlight
