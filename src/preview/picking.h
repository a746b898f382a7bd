// What a pixel of the picture shows: the ray behind it, the object that it meets first, and where it meets a plane.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "calibration/camera.h"
#include "core/transforms.h"
#include "core/warnings.h"
#include "scene/model.h"
#include "scene/object_motion.h"
#include "scene/scene_file.h"
#include "scene/sphere_set.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// In the world. The direction is one long along the camera's axis: distances along it are depths.
struct PixelRay {
    Eigen::Vector3d origin_m = Eigen::Vector3d::Zero(), direction = Eigen::Vector3d::UnitZ();

    Eigen::Vector3d at(double depth_m) const { return origin_m + depth_m * direction; }
};

/// Of a pixel (centres at whole numbers), through the lens with its distortion; nullopt where the lens model does not
/// reach it.
std::optional<PixelRay> ray_of_pixel(const Camera& camera, const RigidTransform& camera_from_world,
                                     const Eigen::Vector2d& pixel);
/// The way back; nullopt for what is behind the camera.
std::optional<Eigen::Vector2d> pixel_of_point(const Camera& camera, const RigidTransform& camera_from_world,
                                              const Eigen::Vector3d& point_m);

using Plane = Eigen::Hyperplane<double, 3>;

/// z = `height_m`, of the world.
Plane level_plane(double height_m);
/// That a tag is printed on; nullopt where the solve does not know its place.
std::optional<Plane> plane_of_tag(const Solve& solve, int tag);
/// Through what stands on world or tag, in the directions that its `translate` calls x and y. Throws InputError where
/// the solve does not know the tag.
Plane plane_of_object(const Scene& scene, std::size_t object, const Solve& solve, const ClipTime& time);
/// Where the ray meets it before the camera; nullopt where it does not, or so flatly that a pixel would be metres.
std::optional<Eigen::Vector3d> meet(const PixelRay& ray, const Plane& plane);

/// Where the scene's objects stand at a time, in its order. Throws InputError as plane_of_object() does.
std::vector<Eigen::Matrix4d> placements_of(const Scene& scene, const Solve& solve, const ClipTime& time);

struct Pick {
    std::optional<std::size_t> object;  // nullopt: the real surface
    double depth_m = 0;                 // along the camera's axis
    Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
};

/// The objects' triangles and spheres, each in its own axes, so that what moves needs nothing anew.
class PickTargets {
public:
    PickTargets();
    ~PickTargets();
    PickTargets(PickTargets&&) noexcept;
    PickTargets& operator=(PickTargets&&) noexcept;

    /// The scene's objects; what was there before is not loaded again. Throws InputError.
    void set_scene(const Scene& scene);

    // Or one by one.
    void add(const Model& model);
    void add(SphereSet spheres);

    /// Animated models are met as they stand at that time of the clip, in seconds.
    void set_time(double time_s);

    /// The object that the ray meets first. One placement an object.
    std::optional<Pick> first_object(const PixelRay& ray, std::span<const Eigen::Matrix4d> world_from_model) const;
    /// That, or the real surface where that is nearer: what a lens focuses on there.
    std::optional<Pick> first(const PixelRay& ray, std::span<const Eigen::Matrix4d> world_from_model,
                              const SurfaceSettings& surface) const;

private:
    struct Target;
    std::vector<std::shared_ptr<Target>> targets_;
};

}  // namespace matchlight
