// Loads models, finds what they stand on, moves those that move.
#include "compositor/scene_objects.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "render/surface_mesh.h"
#include "scene/mesh_geometry.h"
#include "scene/model.h"
#include "scene/sphere_file.h"
#include "scene/sphere_mesh.h"
#include "scene/subdivide.h"
#include "scene/surface_pictures.h"

namespace matchlight {

Eigen::Affine3d world_from_parent(const ObjectSettings& object, const Solve& solve,
                                  const std::filesystem::path& scene) {
    if (!object.parent_tag) return Eigen::Affine3d::Identity();
    for (const SolvedTag& tag : solve.rig) {
        if (tag.id == *object.parent_tag) return Eigen::Affine3d(tag.world_from_tag);
    }
    throw InputError(scene,
                     fmt::format("object '{}' stands on tag {}, whose place the solve does not know", object.name,
                                 *object.parent_tag),
                     "track the clip again with that tag in the rig");
}

namespace {

/// Shadows between objects are kept at vertices: a face is given some, about as many along a model as a small shadow
/// needs. Larger meshes stay as they are, being fine already.
void shorten_edges(Model& model, bool is_holdout) {
    // Real things are the larger ones: the shadow on a wall is of what stands before a part of it.
    const double edges_along_model = is_holdout ? 64 : 48;
    constexpr std::size_t most_vertices = 200'000;
    const double longest_m = model.bounds_m.sizes().maxCoeff() / edges_along_model;
    for (ModelMesh& mesh : model.meshes) mesh = with_short_edges(mesh, longest_m, most_vertices);
}

/// Light that falls on the one side of an open shape does not fall on the other.
void add_back_sides(Model& model) {
    for (ModelMesh& mesh : model.meshes) {
        if (is_closed_outward_surface(mesh)) continue;
        const std::size_t vertices = mesh.vertices.size(), indices = mesh.indices.size();
        for (std::size_t i = 0; i < vertices; ++i) {
            mesh.vertices.push_back(back_of(mesh.vertices[i]));
            const auto number = static_cast<std::uint32_t>(i);
            if (mesh.binding) mesh.derived.push_back({number, number});
        }
        for (std::size_t i = 0; i + 2 < indices; i += 3) {
            for (const std::size_t corner : {i, i + 2, i + 1})
                mesh.indices.push_back(mesh.indices[corner] + static_cast<std::uint32_t>(vertices));
        }
    }
}

void refuse_pictures(const ObjectSettings& object, const std::filesystem::path& scene) {
    if (object.material.texture.empty() && object.material.detail == SurfaceDetail{}) return;
    throw InputError(scene, fmt::format("object '{}' is a set of spheres, which takes no texture", object.name),
                     "colour it by a column: color_column of [object.sphere]");
}

}  // namespace

Model load_object_model(const ObjectSettings& object, const std::filesystem::path& scene, Warnings& warnings) {
    if (!object.model.empty()) return load_model(object.model, warnings);
    if (object.spheres.empty()) return make_shape(object.shape, scene);
    refuse_pictures(object, scene);
    const SphereSet set = load_sphere_set(object.spheres, object.sphere, warnings);
    const std::optional<int> halvings = sphere_halvings(set.size());
    if (!halvings) {
        throw InputError(scene,
                         fmt::format("object '{}' stands for a real thing with {} spheres of {}", object.name,
                                     set.size(), object.spheres.string()),
                         fmt::format("give a holdout {} at most, or a model in their place",
                                     most_sphere_triangles / sphere_triangles(fewest_sphere_halvings)));
    }
    return mesh_of_spheres(set, *halvings);
}

SceneObjects::SceneObjects(SurfaceRenderer& surfaces, const Scene& scene, const Solve& solve, const ClipTime& time,
                           const ObjectPreparation& preparation, Warnings& warnings)
    : surfaces_(surfaces) {
    if (preparation.traced) rays_.emplace();
    int id = 0;
    for (const ObjectSettings& object : scene.objects) {
        objects_.push_back({object, world_from_parent(object, solve, scene.path)});
        SurfaceObject added{.model = nullptr,
                            .world_from_model = world_from_model(objects_.size() - 1, time),
                            .material = object.material,
                            .reflection = object.reflection,
                            .id = ++id,
                            .casts_shadow = object.casts_shadow,
                            .is_holdout = object.holdout};
        Model model;  // of spheres: without a mesh
        const bool is_spheres = !object.spheres.empty() && !object.holdout;
        if (is_spheres) {
            add_spheres(added, object, scene.path, warnings);
        } else {
            model = load_object_model(object, scene.path, warnings);
            if (!object.material.texture.empty()) set_base_color_texture(model, object.material.texture);
            std::optional<SurfacePictures> pictures;
            if (object.material.detail != SurfaceDetail{})
                pictures = load_surface_pictures(model, object.material, warnings);
            if (preparation.fine_meshes) shorten_edges(model, object.holdout);
            if (object.holdout) add_back_sides(model);
            added.model = &model;
            if (pictures) added.pictures = &*pictures;
            surfaces.add_object(added);
            for (const ModelLamp& lamp : model.lamps) model_lamps_.push_back({objects_.size() - 1, lamp});
        }
        if (rays_ && !is_spheres) rays_->add_object(model, object.material, object.holdout);
        PosedModel posed(model, object.animation.name, object.model.empty() ? scene.path : object.model);
        if (posed.moves()) deforming_.push_back({objects_.size() - 1, std::move(posed)});
        if (is_moving(objects_.size() - 1)) moving_.push_back(objects_.size() - 1);
    }
    if (rays_) rays_->finish();
    for (std::size_t i = 0; i < objects_.size(); ++i) placed_.push_back(surfaces_.world_from_model(i));
    poses_.assign(deforming_.size(), std::numeric_limits<double>::quiet_NaN());
    deform(time);
    place_rays();
}

void SceneObjects::set_scene(const Scene& scene, const Solve& solve, const ClipTime& time) {
    std::vector<Object> changed;
    for (const ObjectSettings& object : scene.objects) {
        changed.push_back({object, world_from_parent(object, solve, scene.path)});
    }
    objects_ = std::move(changed);
    moving_.clear();
    for (std::size_t i = 0; i < objects_.size(); ++i) {
        if (is_moving(i)) moving_.push_back(i);
        placed_[i] = world_from_model(i, time);
        surfaces_.place_object(i, placed_[i]);
    }
    deform(time);
    place_rays();
}

void SceneObjects::add_spheres(const SurfaceObject& added, const ObjectSettings& object,
                               const std::filesystem::path& scene, Warnings& warnings) {
    refuse_pictures(object, scene);
    SurfaceObject with_halo = added;
    with_halo.halo = object.sphere.halo;
    const SphereSet set = load_sphere_set(object.spheres, object.sphere, warnings);
    surfaces_.add_spheres(with_halo, set);
    if (!rays_) return;
    rays_->add_spheres(set, object.material);
    if (!RayScene::meets(set) && !set.blends()) {
        warnings.add(fmt::format("object '{}': {} spheres are more than rays meet ({}): mirrors do not show them",
                                 object.name, set.size(), RayScene::most_spheres));
    }
}

Eigen::Matrix4d SceneObjects::world_from_model(std::size_t object, const ClipTime& time) const {
    const Object& placed = objects_.at(object);
    return (placed.world_from_parent * object_placement(placed.settings, time)).matrix();
}

void SceneObjects::place(const ClipTime& time) {
    for (const std::size_t object : moving_) {
        placed_[object] = world_from_model(object, time);
        surfaces_.place_object(object, placed_[object]);
    }
    deform(time);
    place_rays();
}

bool SceneObjects::deforms(std::size_t object) const {
    return std::ranges::any_of(deforming_, [&](const Deforming& one) { return one.object == object; });
}

const std::vector<ModelMesh>& SceneObjects::meshes_at(Deforming& deforming, const ClipTime& time) const {
    const AnimationSettings& settings = objects_[deforming.object].settings.animation;
    return deforming.model.at(deforming.model.animation_time_s(settings, time.time_s));
}

void SceneObjects::deform(const ClipTime& time) {
    for (std::size_t i = 0; i < deforming_.size(); ++i) {
        Deforming& deforming = deforming_[i];
        const AnimationSettings& settings = objects_[deforming.object].settings.animation;
        const double pose_s = deforming.model.animation_time_s(settings, time.time_s);
        if (poses_[i] == pose_s) continue;
        poses_[i] = pose_s;
        const std::vector<ModelMesh>& meshes = deforming.model.at(pose_s);
        surfaces_.deform_object(deforming.object, meshes);
        if (rays_) rays_->deform_object(deforming.object, meshes);
    }
}

std::vector<Eigen::Vector3d> SceneObjects::positions_m(std::size_t object, const ClipTime& time) {
    std::vector<Eigen::Vector3d> positions_m;
    for (Deforming& deforming : deforming_) {
        if (deforming.object != object) continue;
        for (const ModelMesh& mesh : meshes_at(deforming, time)) {
            for (const ModelVertex& vertex : mesh.vertices)
                positions_m.push_back(Eigen::Vector3f(vertex.position.data()).cast<double>());
        }
    }
    return positions_m;
}

void SceneObjects::set_ways(const ClipTime& opening, const ClipTime& closing) {
    for (Deforming& deforming : deforming_) {
        surfaces_.set_way_end(deforming.object, meshes_at(deforming, opening), WayEnd::opening);
        surfaces_.set_way_end(deforming.object, meshes_at(deforming, closing), WayEnd::closing);
    }
}

std::vector<LampSettings> SceneObjects::lamps() const {
    std::vector<LampSettings> lamps;
    for (const LampOfObject& held : model_lamps_) {
        const ObjectSettings& settings = objects_[held.object].settings;
        if (settings.lights == 0 || settings.holdout) continue;
        Eigen::Matrix4d model_from_node = held.lamp.model_from_node;
        for (std::size_t i = 0; i < deforming_.size(); ++i) {
            if (deforming_[i].object == held.object && std::isfinite(poses_[i]))
                model_from_node = deforming_[i].model.model_from_node(held.lamp.node, poses_[i]);
        }
        const Eigen::Matrix4d world_from_node = placed_[held.object] * model_from_node;
        LampSettings lamp = held.lamp.lamp;
        lamp.intensity *= settings.lights;
        lamp.position_m = world_from_node.topRightCorner<3, 1>();
        // A light is not scaled with its node, says the extension: only turned. Flattened to nothing it shines nowhere.
        const Eigen::Vector3d forward = -world_from_node.col(2).head<3>();
        if (!(forward.norm() > 0) || !lamp.position_m.allFinite()) continue;
        lamp.direction = forward.normalized();
        lamp.in_footage = false;
        lamps.push_back(lamp);
    }
    return lamps;
}

void SceneObjects::place_rays() {
    if (rays_) rays_->place(placed_);
}

PlacementChange SceneObjects::change_since_lit() const {
    PlacementChange change;
    const auto is_posed_otherwise = [&](std::size_t object) {
        for (std::size_t i = 0; i < deforming_.size(); ++i) {
            if (deforming_[i].object == object && poses_[i] != lit_poses_[i]) return true;
        }
        return false;
    };
    for (std::size_t i = 0; i < placed_.size(); ++i) {
        if (i < lit_.size() && placed_[i] == lit_[i] && !is_posed_otherwise(i)) continue;
        change.any = true;
        const ObjectSettings& moved = objects_[i].settings;
        const bool shines = std::ranges::any_of(
            model_lamps_, [&](const LampOfObject& held) { return held.object == i && moved.lights > 0; });
        change.casters = change.casters || (moved.casts_shadow && !moved.holdout) || shines;
    }
    return change;
}

}  // namespace matchlight
