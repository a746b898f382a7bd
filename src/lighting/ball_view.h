// A camera place from which a mirror ball was photographed, and all that is found out about it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calibration/camera.h"
#include "core/image.h"
#include "core/transforms.h"
#include "lighting/ball_outline.h"
#include "lighting/mirror_ball.h"

namespace matchlight {

struct BallView {
    std::filesystem::path name;  // of its first photograph, for messages
    ImageF radiance;             // RGB, merged; every view in the same units
    ImageF sigma;                // RGB, of radiance
    Image8 clipped;              // 255 where every photograph is clipped: radiance is a lower bound
    Camera camera;               // of the photographs' size
    BallOutline outline;
    std::optional<RigidTransform> camera_from_world;  // absent where no rig is known
    double rig_correlation = 0;                       // of the picture with the rig's, where it was fitted
    bool pose_from_ball = false;                      // no tag was whole: the rig was sought around the ball

    /// In the world's frame.
    Eigen::Vector3d eye_m() const { return camera_from_world->inverse().translation(); }
    /// A pixel's ray in the world's frame, unit length; NaN where the lens does not reach.
    Eigen::Vector3d ray(const Eigen::Vector2d& pixel) const {
        const Eigen::Vector2d normalized = camera.normalized_from_pixel(pixel);
        return camera_from_world->linear().transpose() * normalized.homogeneous().normalized();
    }
    Eigen::Vector2d pixel(const Eigen::Vector3d& world_m) const {
        return camera.pixel_from_camera(*camera_from_world * world_m);
    }
    bool in_front(const Eigen::Vector3d& world_m) const { return (*camera_from_world * world_m).z() > 0; }
    bool in_frame(const Eigen::Vector2d& pixel) const {
        return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= radiance.width() - 1 &&
               pixel.y() <= radiance.height() - 1;
    }
};

/// The pixel in which a view sees a place directly, past the ball: its ray misses the centre by at least `clear` radii.
/// nullopt where the ball, the frame or the lens' reach is in the way.
std::optional<Eigen::Vector2d> direct_pixel(const BallView& view, const MirrorBall& ball,
                                            const Eigen::Vector3d& place_m, double clear);

/// Bilinear, RGB; clamped at the frame's edge.
Eigen::Vector3d sample_rgb(const ImageF& image, const Eigen::Vector2d& pixel);

/// The view at half its size, every pixel the mean of four; an odd last row or column is left out.
BallView halved(const BallView& view);

}  // namespace matchlight
