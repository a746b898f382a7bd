// Casts a ray through each pixel that could see one.
#include "compositor/surface_holdouts.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compositor/reach.h"
#include "compositor/scene_objects.h"
#include "compositor/shutter.h"
#include "core/parallel.h"
#include "scene/ray_caster.h"
#include "scene/sphere_file.h"

namespace matchlight {

namespace {

/// Pixels beside one show it, too: by the camera's own blur and the footage's subsampled colour.
constexpr int margin_px = 2;

/// What decides where the spheres of a file are, and how large.
void add_spheres_as_read(ContentHash& hash, const ObjectSettings& object) {
    const SphereSettings& sphere = object.sphere;
    add_sphere_contents(hash, object.spheres);
    hash.add(fmt::format("{:.17g} {} {:.17g} {} {}", sphere.radius.value_or(0), sphere.radius_column,
                         sphere.radius_scale, static_cast<int>(sphere.up), sphere.frame));
}

void widen(Image8& mask, const Region& around) {
    const Image8 before = mask;
    parallel_for(around.height, [&](int row) {
        const int y = around.y + row;
        for (int x = around.x; x < around.x + around.width; ++x) {
            const Region near = Region{x, y, 1, 1}.grown(margin_px).intersected(mask.bounds());
            for (int v = near.y; v < near.y + near.height; ++v) {
                for (int u = near.x; u < near.x + near.width; ++u)
                    mask.at(x, y) = std::max(mask.at(x, y), before.at(u, v));
            }
        }
    });
}

}  // namespace

SurfaceHoldouts::SurfaceHoldouts(const Scene& scene, const Solve& solve, Warnings& warnings)
    : camera_(solve.camera), surface_z_m_(scene.surface.z_m) {
    for (const ObjectSettings& object : scene.objects) {
        if (!object.holdout) continue;
        Model model = load_object_model(object, scene.path, warnings);
        PosedModel posed(model, object.animation.name, object.model.empty() ? scene.path : object.model);
        holdouts_.push_back({std::move(model), object, world_from_parent(object, solve, scene.path), std::move(posed)});
    }
}

Image8 SurfaceHoldouts::before_surface(const SolvedFrame& frame, const LensMap& lens_map) const {
    RayCaster caster;
    Region seen;
    for (const Holdout& holdout : holdouts_) {
        const Eigen::Affine3d world_from_model =
            holdout.world_from_parent * object_placement(holdout.settings, time_of(frame));
        Eigen::AlignedBox3d box_m;
        PosedModel posed = holdout.posed;
        const double pose_s = posed.animation_time_s(holdout.settings.animation, time_of(frame).time_s);
        for (const ModelMesh& mesh : posed.moves() ? posed.at(pose_s) : holdout.model.meshes) {
            std::vector<Eigen::Vector3d> positions_m;
            for (const ModelVertex& vertex : mesh.vertices) {
                const Eigen::Vector3d position = Eigen::Vector3f(vertex.position.data()).cast<double>();
                positions_m.emplace_back(world_from_model * position);
                box_m.extend(positions_m.back());
            }
            caster.add_mesh(positions_m, mesh.indices);
        }
        if (box_m.isEmpty()) continue;
        const Eigen::AlignedBox2d bounds = normalized_bounds_of_box(box_m, *frame.camera_from_world, lens_map);
        if (!bounds.isEmpty()) seen = seen.united(plate_region(bounds, camera_, lens_map, margin_px));
    }
    if (seen.empty()) return {};
    caster.build();
    const RigidTransform world_from_camera = frame.camera_from_world->inverse();
    const Eigen::Vector3d eye_m = world_from_camera.translation();
    Image8 mask(camera_.width, camera_.height, 1);
    parallel_for(seen.height, [&](int row) {
        const int y = seen.y + row;
        for (int x = seen.x; x < seen.x + seen.width; ++x) {
            const Eigen::Vector2d normalized = lens_map.normalized(x, y);
            if (!normalized.allFinite()) continue;
            const Eigen::Vector3d direction = world_from_camera.linear() * normalized.homogeneous();
            const double to_surface = (surface_z_m_ - eye_m.z()) / direction.z();
            const auto hit = caster.nearest(eye_m, direction, 0);
            // A sheet that lies on the surface is not the surface, however near.
            constexpr double rounding = 1 + 1e-9;
            if (hit && to_surface > 0 && hit->distance_m <= rounding * to_surface) mask.at(x, y) = 255;
        }
    });
    widen(mask, seen);
    return mask;
}

void add_holdouts(ContentHash& hash, const Scene& scene, const Solve& solve,
                  std::span<const SolvedFrame* const> frames) {
    Warnings unheard;  // loading says the same
    unheard.set_quiet(true);
    for (const ObjectSettings& object : scene.objects) {
        if (!object.holdout) continue;
        hash.add(object.shape);
        if (!object.model.empty()) add_model_contents(hash, object.model, unheard);
        if (!object.spheres.empty()) add_spheres_as_read(hash, object);
        const Eigen::Affine3d world_from = world_from_parent(object, solve, scene.path);
        const AnimationSettings& animation = object.animation;
        hash.add(
            fmt::format("{} {:.17g} {:.17g} {}", animation.name, animation.speed, animation.start_s, animation.loop));
        for (const SolvedFrame* frame : frames) {
            hash.add(fmt::format("{:.17g}", frame->time_s));
            const Eigen::Affine3d placement = world_from * object_placement(object, time_of(*frame));
            for (const double value : placement.matrix().reshaped()) hash.add(fmt::format("{:.17g}", value));
        }
    }
}

}  // namespace matchlight
