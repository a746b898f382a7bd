// The thin lens: what is sharp, and how wide a point that is not becomes in the picture.
//
// f focal length, N f-number, z_f focus distance, z depth, all measured from the lens. The formulas are those of
// Potmesil & Chakravarty (1981), A Lens and Aperture Camera Model for Synthetic Image Generation, written in inverse
// depth, where they stay finite to infinity and exact near the focus.
#pragma once

#include <limits>

namespace matchlight {

/// What the circle of confusion depends on, as a solve has it. The calibrated focal length in pixels already holds the
/// image distance: scale = fx · f/N.
struct Focus {
    double coc_scale_px_m = 0;                                          // 0: a pinhole
    double focus_distance_m = std::numeric_limits<double>::infinity();  // positive
};

/// A lens by its own data, focused.
struct ThinLens {
    double focal_length_m = 0;
    double f_number = 0;
    double focus_distance_m = std::numeric_limits<double>::infinity();  // beyond the focal length
    double sensor_width_m = 0.036;
    int image_width_px = 1920;
};

/// z_f·f / (z_f − f): from the lens to the sensor; infinite at z_f = f, where the picture would be.
double image_distance_m(const ThinLens& lens);

/// The pinhole's focal length in pixels: image distance over the pixel's pitch.
double focal_px(const ThinLens& lens);

Focus focus_of(const ThinLens& lens);

/// Diameter of the circle of confusion, positive beyond the focus and negative before it:
/// scale · (1/z_f − 1/z). Infinite at z = 0.
double signed_coc_px(const Focus& focus, double depth_m);

/// The depths between which the circle of confusion is no wider than `acceptable_px`; `far_m` may be infinite.
struct DepthOfField {
    double near_m = 0;
    double far_m = 0;
};
DepthOfField depth_of_field(const Focus& focus, double acceptable_px);

/// The nearest focus distance at which infinity is still acceptable, the lens focused there: f²/(N·c) + f, with c the
/// circle on the sensor.
double hyperfocal_m(const ThinLens& lens, double acceptable_px);
/// The same where only the pair of the solve is known, whose scale is held: scale / c.
double hyperfocal_m(const Focus& focus, double acceptable_px);

}  // namespace matchlight
