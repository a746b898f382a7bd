// Loads models, finds what they stand on, moves those that move.
#include "compositor/scene_objects.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "render/surface_mesh.h"
#include "scene/model.h"
#include "scene/sphere_file.h"
#include "scene/subdivide.h"

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
            ModelVertex behind = mesh.vertices[i];
            for (float& component : behind.normal) component = -component;
            mesh.vertices.push_back(behind);
        }
        for (std::size_t i = 0; i + 2 < indices; i += 3) {
            for (const std::size_t corner : {i, i + 2, i + 1})
                mesh.indices.push_back(mesh.indices[corner] + static_cast<std::uint32_t>(vertices));
        }
    }
}

}  // namespace

SceneObjects::SceneObjects(SurfaceRenderer& surfaces, const Scene& scene, const Solve& solve, const ClipTime& time,
                           const ObjectPreparation& preparation, Warnings& warnings)
    : surfaces_(surfaces) {
    if (preparation.traced) rays_.emplace();
    int id = 0;
    for (const ObjectSettings& object : scene.objects) {
        if (moves(object)) moving_.push_back(objects_.size());
        objects_.push_back({object, world_from_parent(object, solve, scene.path)});
        SurfaceObject added{.model = nullptr,
                            .world_from_model = world_from_model(objects_.size() - 1, time),
                            .material = object.material,
                            .reflection = object.reflection,
                            .id = ++id,
                            .casts_shadow = object.casts_shadow,
                            .is_holdout = object.holdout};
        Model model;  // of spheres: without a mesh
        if (!object.spheres.empty()) {
            add_spheres(added, object, scene.path, warnings);
        } else {
            model = object.model.empty() ? make_shape(object.shape, scene.path) : load_model(object.model, warnings);
            if (!object.material.texture.empty()) set_base_color_texture(model, object.material.texture);
            if (preparation.fine_meshes) shorten_edges(model, object.holdout);
            if (object.holdout) add_back_sides(model);
            added.model = &model;
            surfaces.add_object(added);
        }
        if (rays_) rays_->add_object(model, object.material, object.holdout);
    }
    if (rays_) rays_->finish();
    for (std::size_t i = 0; i < objects_.size(); ++i) placed_.push_back(surfaces_.world_from_model(i));
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
        if (moves(objects_[i].settings)) moving_.push_back(i);
        placed_[i] = world_from_model(i, time);
        surfaces_.place_object(i, placed_[i]);
    }
    place_rays();
}

void SceneObjects::add_spheres(const SurfaceObject& added, const ObjectSettings& object,
                               const std::filesystem::path& scene, Warnings& warnings) {
    if (object.holdout) {
        throw InputError(
            scene, fmt::format("object '{}' is a set of spheres, which cannot stand for a real thing", object.name),
            "use a model or a shape as holdout");
    }
    if (!object.material.texture.empty()) {
        throw InputError(scene, fmt::format("object '{}' is a set of spheres, which takes no texture", object.name),
                         "colour it by a column: color_column of [object.sphere]");
    }
    surfaces_.add_spheres(added, load_sphere_set(object.spheres, object.sphere, warnings));
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
    place_rays();
}

void SceneObjects::place_rays() {
    if (rays_) rays_->place(placed_);
}

PlacementChange SceneObjects::change_since_lit() const {
    PlacementChange change;
    for (std::size_t i = 0; i < placed_.size(); ++i) {
        if (i < lit_.size() && placed_[i] == lit_[i]) continue;
        change.any = true;
        const ObjectSettings& moved = objects_[i].settings;
        change.casters = change.casters || (moved.casts_shadow && !moved.holdout);
    }
    return change;
}

}  // namespace matchlight
