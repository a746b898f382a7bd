// Rays in each object's own axes, so that what moves needs no new hierarchy of boxes.
#include "compositor/autofocus.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "render/virtual_layer.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;

struct Ray {
    Vector3d origin_m, direction;  // world
};

/// In multiples of the ray's direction: affine maps, which place objects, leave them as they are.
std::optional<double> first_hit(const FocusObject& object, const Ray& ray, double least) {
    const Eigen::Affine3d model_from_world(object.world_from_model.inverse());
    const auto hit =
        object.triangles.nearest(model_from_world * ray.origin_m, model_from_world.linear() * ray.direction, least);
    return hit ? std::optional(hit->distance_m) : std::nullopt;
}

void warn_of(std::string_view cause, Warnings& warnings) {
    warnings.add(fmt::format(
        "focus_on of depth of field: {}: such frames keep the focus distance of the solve, the camera or the settings",
        cause));
}

std::optional<double> depth_of_point(const Vector3d& point_m, const FocusView& view, Warnings& warnings) {
    const double depth_m = (view.camera_from_world * point_m).z();
    if (depth_m > near_plane_m) return depth_m;
    warn_of("the point is behind the camera", warnings);
    return std::nullopt;
}

std::optional<double> depth_of_object(const std::string& name, const FocusView& view, Warnings& warnings) {
    const auto found = std::ranges::find(view.objects, name, &FocusObject::name);
    if (found == view.objects.end() || found->box_m.isEmpty()) {
        warn_of(fmt::format("there is nothing of an object '{}'", name), warnings);
        return std::nullopt;
    }
    const Vector3d centre_m = (found->world_from_model * found->box_m.center().homogeneous()).hnormalized();
    const double centre_depth_m = (view.camera_from_world * centre_m).z();
    if (!(centre_depth_m > near_plane_m)) {
        warn_of(fmt::format("the middle of object '{}' is behind the camera", name), warnings);
        return std::nullopt;
    }
    const Vector3d eye_m = view.camera_from_world.inverse().translation();
    const auto share = first_hit(*found, {eye_m, centre_m - eye_m}, near_plane_m / centre_depth_m);
    return centre_depth_m * std::min(share.value_or(1.0), 1.0);
}

std::optional<double> depth_of_middle(const FocusView& view, Warnings& warnings) {
    const Eigen::Vector2d middle_px(0.5 * (view.camera.width - 1), 0.5 * (view.camera.height - 1));
    const Eigen::Vector2d normalized = view.camera.normalized_from_pixel(middle_px);
    const RigidTransform world_from_camera = view.camera_from_world.inverse();
    // One along the axis, so that distances are depths.
    const Vector3d direction = world_from_camera.linear() * normalized.homogeneous();
    const Ray ray{world_from_camera.translation(), direction};
    std::optional<double> nearest_m;
    const auto consider = [&](std::optional<double> depth_m) {
        if (depth_m && *depth_m > near_plane_m && (!nearest_m || *depth_m < *nearest_m)) nearest_m = depth_m;
    };
    for (const FocusObject& object : view.objects) consider(first_hit(object, ray, near_plane_m));
    if (view.surface_z_m && direction.z() != 0) consider((*view.surface_z_m - ray.origin_m.z()) / direction.z());
    if (!nearest_m) warn_of("nothing is in the middle of the picture", warnings);
    return nearest_m;
}

}  // namespace

std::optional<double> autofocus_depth_m(const DepthOfFieldSettings& settings, const FocusView& view,
                                        Warnings& warnings) {
    switch (settings.focus_on) {
        case FocusTarget::distance:
            return std::nullopt;
        case FocusTarget::point:
            return depth_of_point(Vector3d(settings.focus_point_m.data()), view, warnings);
        case FocusTarget::object:
            return depth_of_object(settings.focus_object, view, warnings);
        case FocusTarget::middle:
            return depth_of_middle(view, warnings);
    }
    return std::nullopt;
}

}  // namespace matchlight
