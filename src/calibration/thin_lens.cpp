// Circle of confusion and depth of field in inverse depth.
#include "calibration/thin_lens.h"

#include <cassert>
#include <cmath>

namespace matchlight {

namespace {

double pixel_pitch_m(const ThinLens& lens) {
    return lens.sensor_width_m / lens.image_width_px;
}

}  // namespace

double image_distance_m(const ThinLens& lens) {
    assert(lens.focal_length_m > 0 && lens.focus_distance_m >= lens.focal_length_m);
    // By f/z_f, so that infinity needs no case of its own.
    return lens.focal_length_m / (1 - lens.focal_length_m / lens.focus_distance_m);
}

double focal_px(const ThinLens& lens) {
    return image_distance_m(lens) / pixel_pitch_m(lens);
}

Focus focus_of(const ThinLens& lens) {
    assert(lens.f_number > 0);
    return {focal_px(lens) * lens.focal_length_m / lens.f_number, lens.focus_distance_m};
}

double signed_coc_px(const Focus& focus, double depth_m) {
    if (focus.coc_scale_px_m == 0) return 0;
    const double focused = focus.focus_distance_m;
    // Near the focus the difference of the depths is exact, that of their inverses is not.
    const double difference = std::isfinite(focused) && std::isfinite(depth_m) ? (depth_m - focused) / depth_m / focused
                                                                               : 1 / focused - 1 / depth_m;
    return focus.coc_scale_px_m * difference;
}

DepthOfField depth_of_field(const Focus& focus, double acceptable_px) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    if (focus.coc_scale_px_m == 0) return {0, infinity};
    const double half_width = acceptable_px / focus.coc_scale_px_m;  // in inverse depth
    const double farthest = 1 / focus.focus_distance_m - half_width;
    return {1 / (1 / focus.focus_distance_m + half_width), farthest > 0 ? 1 / farthest : infinity};
}

double hyperfocal_m(const ThinLens& lens, double acceptable_px) {
    const double circle_m = acceptable_px * pixel_pitch_m(lens);
    return lens.focal_length_m * lens.focal_length_m / (lens.f_number * circle_m) + lens.focal_length_m;
}

double hyperfocal_m(const Focus& focus, double acceptable_px) {
    return focus.coc_scale_px_m / acceptable_px;
}

}  // namespace matchlight
