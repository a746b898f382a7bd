// What the lens is focused on by itself: a point, an object, or what is in the picture's middle.
#pragma once

#include <optional>
#include <span>
#include <string>

#include <Eigen/Geometry>

#include "calibration/camera.h"
#include "core/transforms.h"
#include "core/warnings.h"
#include "scene/effects.h"
#include "scene/ray_caster.h"

namespace matchlight {

/// An object's triangles in the axes of its model, and how it stands in the frame.
struct FocusObject {
    std::string name;
    RayCaster triangles;
    Eigen::AlignedBox3d box_m;  // around them
    Eigen::Matrix4d world_from_model = Eigen::Matrix4d::Identity();
};

/// What a frame's lens looks at.
struct FocusView {
    const Camera& camera;
    RigidTransform camera_from_world;
    std::span<const FocusObject> objects;
    std::optional<double> surface_z_m;  // height of the real surface, where there is one
};

/// The depth along the camera's axis that `settings.focus_on` asks for:
///  - point: of that point;
///  - object: of the nearest of the object's own triangles on the way to its box's centre, as one focuses on the front
///    of a thing; of the centre where that way leads through a hole. What stands before the object does not count;
///  - middle: of the first triangle of any object, or of the real surface, on the ray of the picture's middle.
/// nullopt where it is a distance, and, with a warning, where there is nothing to focus on before the camera: then the
/// distance of the solve or the camera holds.
std::optional<double> autofocus_depth_m(const DepthOfFieldSettings& settings, const FocusView& view,
                                        Warnings& warnings);

}  // namespace matchlight
