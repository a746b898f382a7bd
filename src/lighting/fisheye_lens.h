// Fisheye lenses: where a direction falls in the round picture of one.
#pragma once

#include <array>
#include <optional>
#include <string>

#include <Eigen/Core>

namespace matchlight {

/// How far from the centre the angle θ from the axis falls, in focal lengths: θ, 2 sin(θ/2), sin θ, 2 tan(θ/2), or
/// θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸) (Kannala & Brandt 2006, as OpenCV has it).
enum class FisheyeProjection { equidistant, equisolid, orthographic, stereographic, kannala_brandt };

/// A circle in a picture; pixel centres at whole numbers.
struct PixelCircle {
    Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
    double radius_px = 0;
};

struct FisheyeLens {
    FisheyeProjection projection = FisheyeProjection::equidistant;
    Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
    Eigen::Vector2d focal_px = Eigen::Vector2d::Zero();  // pixels a radian in the middle
    std::array<double, 4> k{};                           // of kannala_brandt
    double most_angle = 0;                               // radians from the axis: the rim of the picture

    /// Distance from the centre in focal lengths.
    double radius_of(double angle) const;
    /// Of a direction in the camera's axes (x right, y down, z along the axis), of unit length; nullopt beyond the rim.
    std::optional<Eigen::Vector2d> pixel_from_direction(const Eigen::Vector3d& direction) const;
};

/// Half the angle of view that the lens can have: past it directions fall on one another. Radians.
double widest_angle(const FisheyeLens& lens);

/// Pixels a radian where the picture is finest, towards its rim, over those in the middle.
double finest_scale(const FisheyeLens& lens);

/// The lens whose picture of `fov` radians across fills the circle.
FisheyeLens lens_of_circle(FisheyeProjection projection, const PixelCircle& circle, double fov);

}  // namespace matchlight
