// Rays in each object's own axes: affine maps leave the multiples of a direction as they are.
#include "preview/picking.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "compositor/scene_objects.h"
#include "render/virtual_layer.h"
#include "scene/model_pose.h"
#include "scene/ray_caster.h"
#include "scene/sphere_caster.h"
#include "scene/sphere_file.h"

namespace matchlight {

using Eigen::Vector3d;

std::optional<PixelRay> ray_of_pixel(const Camera& camera, const RigidTransform& camera_from_world,
                                     const Eigen::Vector2d& pixel) {
    const Eigen::Vector2d normalized = camera.normalized_from_pixel(pixel);
    if (!normalized.allFinite()) return std::nullopt;
    const RigidTransform world_from_camera = camera_from_world.inverse();
    return PixelRay{world_from_camera.translation(), world_from_camera.linear() * normalized.homogeneous()};
}

std::optional<Eigen::Vector2d> pixel_of_point(const Camera& camera, const RigidTransform& camera_from_world,
                                              const Vector3d& point_m) {
    const Vector3d in_camera_m = camera_from_world * point_m;
    if (in_camera_m.z() < near_plane_m) return std::nullopt;
    return camera.pixel_from_camera(in_camera_m);
}

Plane level_plane(double height_m) {
    return {Vector3d::UnitZ(), Vector3d(0, 0, height_m)};
}

std::optional<Plane> plane_of_tag(const Solve& solve, int tag) {
    const auto found = std::ranges::find(solve.rig, tag, &SolvedTag::id);
    if (found == solve.rig.end()) return std::nullopt;
    return Plane(found->world_from_tag.linear().col(2), found->world_from_tag.translation());
}

Plane plane_of_object(const Scene& scene, std::size_t object, const Solve& solve, const ClipTime& time) {
    const ObjectSettings& settings = scene.objects.at(object);
    const Eigen::Affine3d world_from_parent = matchlight::world_from_parent(settings, solve, scene.path);
    return {world_from_parent.linear().col(2).normalized(),
            world_from_parent * Vector3d(object_placement(settings, time).translation())};
}

std::optional<Vector3d> meet(const PixelRay& ray, const Plane& plane) {
    const double towards = plane.normal().dot(ray.direction);
    constexpr double flattest = 1e-3;  // a milliradian: a pixel of a usual lens is as wide
    if (std::abs(towards) < flattest * ray.direction.norm()) return std::nullopt;
    const double depth_m = -plane.signedDistance(ray.origin_m) / towards;
    if (!(depth_m > near_plane_m)) return std::nullopt;
    return ray.at(depth_m);
}

std::vector<Eigen::Matrix4d> placements_of(const Scene& scene, const Solve& solve, const ClipTime& time) {
    std::vector<Eigen::Matrix4d> placements;
    for (const ObjectSettings& object : scene.objects) {
        placements.push_back((world_from_parent(object, solve, scene.path) * object_placement(object, time)).matrix());
    }
    return placements;
}

struct PickTargets::Target {
    // What of the settings it was loaded by.
    std::filesystem::path model, sphere_file;
    std::string shape;
    SphereSettings sphere_settings;
    AnimationSettings animation;

    std::optional<PosedModel> posed;  // where an animation moves it
    std::optional<double> posed_at_s;
    RayCaster triangles;
    SphereSet spheres;
    SphereCaster sphere_tree;  // of `spheres`, which therefore stays where it is

    bool is_of(const ObjectSettings& object) const {
        return model == object.model && sphere_file == object.spheres && shape == object.shape &&
               sphere_settings == object.sphere && animation == object.animation;
    }
    void take(const Model& of) {
        take(of.meshes);
        if (of.rig == nullptr) return;
        posed.emplace(of, animation.name, model);
        if (!posed->moves()) posed.reset();
    }
    void take(std::span<const ModelMesh> meshes) {
        triangles = RayCaster();
        for (const ModelMesh& mesh : meshes) {
            std::vector<Vector3d> positions_m;
            for (const ModelVertex& vertex : mesh.vertices) {
                positions_m.push_back(Eigen::Vector3f(vertex.position.data()).cast<double>());
            }
            triangles.add_mesh(positions_m, mesh.indices);
        }
        triangles.build();
    }
    void set_time(double clip_time_s) {
        if (!posed) return;
        const double time_s = posed->animation_time_s(animation, clip_time_s);
        if (std::exchange(posed_at_s, time_s) != time_s) take(posed->at(time_s));
    }
    void take(SphereSet set) {
        spheres = std::move(set);
        sphere_tree.add_set(spheres);
    }
    std::optional<double> nearest(const PixelRay& ray) const {
        std::optional<double> found;
        if (const auto hit = triangles.nearest(ray.origin_m, ray.direction, near_plane_m)) found = hit->distance_m;
        const SphereRay to_spheres{.origin_m = ray.origin_m, .direction = ray.direction, .least = near_plane_m};
        const std::optional<SphereHit> hit =
            sphere_tree.set_count() > 0 ? sphere_tree.nearest(to_spheres) : std::nullopt;
        if (hit && (!found || hit->distance < *found)) found = hit->distance;
        return found;
    }
};

PickTargets::PickTargets() = default;
PickTargets::~PickTargets() = default;
PickTargets::PickTargets(PickTargets&&) noexcept = default;
PickTargets& PickTargets::operator=(PickTargets&&) noexcept = default;

void PickTargets::set_scene(const Scene& scene) {
    Warnings unheard;  // the compositor says the same of its files
    unheard.set_quiet(true);
    std::vector<std::shared_ptr<Target>> targets;
    const auto known = [&](const ObjectSettings& object) -> std::shared_ptr<Target> {
        for (const auto* of : {&targets, &targets_}) {
            const auto found = std::ranges::find_if(*of, [&](const auto& target) { return target->is_of(object); });
            if (found != of->end()) return *found;
        }
        return nullptr;
    };
    for (const ObjectSettings& object : scene.objects) {
        if (auto there = known(object)) {
            targets.push_back(std::move(there));
            continue;
        }
        const auto target = std::make_shared<Target>();
        target->model = object.model;
        target->sphere_file = object.spheres;
        target->shape = object.shape;
        target->sphere_settings = object.sphere;
        target->animation = object.animation;
        if (!object.spheres.empty()) {
            target->take(load_sphere_set(object.spheres, object.sphere, unheard));
        } else {
            target->take(object.model.empty() ? make_shape(object.shape, scene.path)
                                              : load_model(object.model, unheard));
        }
        targets.push_back(target);
    }
    targets_ = std::move(targets);
}

void PickTargets::add(const Model& model) {
    const auto target = std::make_shared<Target>();
    target->take(model);
    targets_.push_back(target);
}

void PickTargets::add(SphereSet spheres) {
    const auto target = std::make_shared<Target>();
    target->take(std::move(spheres));
    targets_.push_back(target);
}

void PickTargets::set_time(double time_s) {
    for (const std::shared_ptr<Target>& target : targets_) target->set_time(time_s);
}

std::optional<Pick> PickTargets::first_object(const PixelRay& ray,
                                              std::span<const Eigen::Matrix4d> world_from_model) const {
    std::optional<Pick> first;
    for (std::size_t i = 0; i < std::min(targets_.size(), world_from_model.size()); ++i) {
        const Eigen::Affine3d model_from_world(world_from_model[i].inverse());
        const auto depth_m =
            targets_[i]->nearest({model_from_world * ray.origin_m, model_from_world.linear() * ray.direction});
        if (depth_m && (!first || *depth_m < first->depth_m)) first = Pick{i, *depth_m, ray.at(*depth_m)};
    }
    return first;
}

std::optional<Pick> PickTargets::first(const PixelRay& ray, std::span<const Eigen::Matrix4d> world_from_model,
                                       const SurfaceSettings& surface) const {
    std::optional<Pick> object = first_object(ray, world_from_model);
    const std::optional<Vector3d> on_surface = surface.present ? meet(ray, level_plane(surface.z_m)) : std::nullopt;
    if (!on_surface) return object;
    const double depth_m = (*on_surface - ray.origin_m).dot(ray.direction) / ray.direction.squaredNorm();
    if (object && object->depth_m <= depth_m) return object;
    return Pick{std::nullopt, depth_m, *on_surface};
}

}  // namespace matchlight
