// What an object is moved, turned, scaled and lifted by: where its handles are, and what a drag of them makes of it.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "preview/picking.h"

namespace matchlight {

enum class Grip { move, turn, size, lift };

/// What a hand takes hold of.
struct Grab {
    Grip grip = Grip::move;
    Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  // of the object, world; for Grip::move
};

/// An object's own three numbers, as the scene has them.
struct Placing {
    Eigen::Vector3d translate_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d rotate_deg = Eigen::Vector3d::Zero();
    Eigen::Vector3d scale = Eigen::Vector3d::Ones();
};

/// In the world: a ring about the object's origin in the plane of what it stands on (the tag's, or the table's), a knob
/// beside it on that plane, and one above it.
struct Handles {
    Eigen::Affine3d world_from_parent = Eigen::Affine3d::Identity();
    Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
    double radius_m = 1;

    Eigen::Vector3d up() const { return world_from_parent.linear().col(2).normalized(); }
    Plane plane() const { return {up(), centre_m}; }
    /// Of so many points, the first of them again at the end.
    std::vector<Eigen::Vector3d> ring(int points) const;
    Eigen::Vector3d size_knob() const;
    Eigen::Vector3d lift_knob() const;
};

/// A drag of one of them, from where it was grabbed.
class HandleDrag {
public:
    /// `ray` is the pointer's. Nullopt where the plane is seen from so flatly that a pixel would be metres.
    static std::optional<HandleDrag> begin(const Grab& grab, const Placing& before, const Handles& handles,
                                           const PixelRay& ray);

    Grip grip() const { return grab_.grip; }
    /// What it makes of the object with the pointer on this ray; nullopt where that leads nowhere. Rounded to what is
    /// worth writing: hundredths of a millimetre and of a degree, four digits of a scale.
    std::optional<Placing> to(const PixelRay& ray) const;

private:
    std::optional<Eigen::Vector3d> reached_m(const PixelRay& ray) const;

    Grab grab_;  // its point: that of the plane or line that was grabbed
    Placing before_;
    Handles handles_;
};

}  // namespace matchlight
