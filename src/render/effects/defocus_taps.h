// Where the methods of depth of field take their samples from; their references share it: no GL.
#pragma once

#include <vector>

#include "scene/effects.h"

namespace matchlight {

/// A sample at whole pixels from the one that is drawn.
struct DefocusTap {
    int x = 0, y = 0;
    float away_px = 0;
    float area_px2 = 1;  // that it stands for
};

/// What trades error for time where samples lie on rings.
struct OnePassKnobs {
    int rings = 12;
    int ring_samples = 24;
    int largest_radius_px = 64;  // wider circles are drawn as this

    /// Throws std::invalid_argument naming what is out of range.
    void check() const;
};

/// Every pixel within the radius and its soft rim.
std::vector<DefocusTap> disc_taps(double radius_px);

/// The pixel itself and rings around it, closer to each other near the middle, where small circles want them; samples
/// that fall on one pixel count as one. The pixel areas add up to the disc's.
std::vector<DefocusTap> ring_taps(double radius_px, const OnePassKnobs& knobs);

/// Texels from which one collects through an opening of `radius` texels, with their areas: the opening turned by 180°,
/// or, before the focus, upright.
std::vector<DefocusTap> bokeh_taps(const BokehSettings& bokeh, double radius, bool before_focus);

/// What has a signed circle from `from_px` to under `to_px` is blurred by one of `circle_px`; 0: it is in focus.
struct DefocusSlice {
    double from_px = 0, to_px = 0;
    double circle_px = 0;
};

/// About `count` slices of equal width, and what is in focus apart from them: back to front, together everything.
std::vector<DefocusSlice> defocus_slices(double nearest_px, double farthest_px, int count);

/// The disc that has the variance of what is looked up on a level of the pyramid: (2 · 4^level − 1)/4 px² along an
/// axis, half of it from the steps down by [1 3 3 1]/8 and half from quadratic B-splines; c²/16 is a disc's. 0: the
/// picture.
double circle_of_level_px(int level);
/// Circles from this on count fully on level 1, 2, …: those that look no finer level up.
double full_circle_of_level_px(int level);

}  // namespace matchlight
