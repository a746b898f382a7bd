// Finds a ball in a photograph and its outline to a fraction of a pixel.
#pragma once

#include <filesystem>
#include <optional>

#include <Eigen/Core>

#include "calibration/camera.h"
#include "core/image.h"

namespace matchlight {

/// A circle given by hand, in pixels.
struct OutlineCircle {
    Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
    double radius_px = 0;
};

/// The rays that touch a sphere are a cone, which the picture shows as an ellipse, bent by the lens.
struct BallOutline {
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // towards the centre, camera frame, unit length
    double half_angle = 0;                            // radians
    double rms_px = 0;                                // of the edges on it
    double support = 0;                               // share of the outline on which an edge was found
    double share_in_frame = 1;
    /// By how many standard deviations more edges lie on the outline than chance would put there.
    double significance = 0;
    double sigma_px = 0;  // standard deviation of the radius, by the edges' scatter

    /// Of a ball of this radius.
    Eigen::Vector3d centre_camera_m(double radius_m) const { return axis * (radius_m / std::sin(half_angle)); }
    /// The pixel of the outline at `turn` radians about the axis.
    Eigen::Vector2d pixel_at(const Camera& camera, double turn) const;
    /// Mean distance of the outline from the picture of the axis.
    double radius_px(const Camera& camera) const;
};

/// The ball in a linear photograph (RGB): circles are proposed by Hough's transform (Yuen et al. 1990, as OpenCV has
/// it), or by `given`, which may be off by a tenth of its radius; each is fitted, robustly, to the edges across it, and
/// the one whose edges chance explains least is taken. Throws InputError, naming `reported` and what
/// was looked for: no ball, or one that the frame cuts.
///
/// At its rim a mirror shows what lies behind it: where that is all of a colour no edge is seen, and a reflected
/// horizon close inside may be taken instead. The radius may then be some per cent too small: fit_ball_to_rig()
/// corrects it.
BallOutline find_ball(const ImageF& radiance, const Camera& camera, const std::optional<OutlineCircle>& given,
                      const std::filesystem::path& reported);

}  // namespace matchlight
