// What objects there are, where they stand, and what their vertices keep.
#include "render/surface.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "render/outlines.h"
#include "render/surface_object.h"
#include "render/surface_targets.h"

namespace matchlight {

SurfaceRenderer::SurfaceRenderer(ShaderLibrary& shaders)
    : shaders_(shaders),
      targets_(std::make_unique<Targets>()),
      holdout_targets_(std::make_unique<Targets>()),
      peeling_(shaders),
      blending_(shaders),
      sphere_edges_(shaders),
      outlines_(std::make_unique<ObjectOutlines>(shaders)) {}
SurfaceRenderer::~SurfaceRenderer() = default;

std::size_t SurfaceRenderer::add_object(const SurfaceObject& object) {
    assert(object.model && object.id > 0);
    const Model& model = *object.model;
    Object added{
        object.world_from_model, object.reflection, object.id, object.casts_shadow, object.is_holdout, {}, {}, {}, {}};
    added.own_materials = model.materials;
    if (added.own_materials.empty()) added.own_materials.emplace_back();
    if (object.pictures != nullptr) {
        const double volume = std::abs(object.world_from_model.topLeftCorner<3, 3>().determinant());
        added.overlay = std::make_unique<SurfaceOverlay>(*object.pictures, std::cbrt(volume));
    }
    for (const ModelMaterial& material : added.own_materials) {
        added.materials.push_back(make_surface_material(model, material, object.material, added.textures));
        added.materials.back().set_overlay(added.overlay.get());
    }
    for (const ModelMesh& mesh : model.meshes) {
        if (mesh.indices.empty()) continue;
        const auto material = static_cast<std::size_t>(std::max(mesh.material, 0));
        assert(material < added.materials.size());
        added.meshes.push_back({SurfaceMesh(mesh), material, vertex_count_});
        vertex_count_ += added.meshes.back().geometry.vertex_count();
    }
    objects_.push_back(std::move(added));
    return objects_.size() - 1;
}

void SurfaceRenderer::place_object(std::size_t index, const Eigen::Matrix4d& world_from_model) {
    objects_.at(index).world_from_model = world_from_model;
}

void SurfaceRenderer::deform_object(std::size_t index, std::span<const ModelMesh> meshes) {
    ++deformations_;
    // Those without triangles were not added.
    std::size_t next = 0;
    for (const ModelMesh& mesh : meshes) {
        if (mesh.indices.empty()) continue;
        if (mesh.binding) objects_.at(index).meshes[next].geometry.set_vertices(mesh.vertices);
        ++next;
    }
}

void SurfaceRenderer::set_way_end(std::size_t index, std::span<const ModelMesh> meshes, WayEnd end) {
    // A mesh that is not bound is at both ends where it is.
    std::size_t next = 0;
    for (const ModelMesh& mesh : meshes) {
        if (!mesh.indices.empty())
            objects_.at(index).meshes[next++].geometry.set_way_end(end == WayEnd::closing, mesh.vertices);
    }
}

bool SurfaceRenderer::set_material(std::size_t index, const MaterialOverride& material) {
    Object& object = objects_.at(index);
    std::vector<SurfaceMaterial> changed;
    for (const ModelMaterial& own : object.own_materials) {
        auto surface = surface_material_of_uploaded(own, material, object.textures);
        if (!surface) return false;
        surface->set_overlay(object.overlay.get());
        changed.push_back(std::move(*surface));
    }
    object.materials = std::move(changed);
    return true;
}

std::vector<float> SurfaceRenderer::reflectances() const {
    std::vector<float> all;
    for (const Object& object : objects_) {
        for (const SurfaceMaterial& material : object.materials) all.push_back(material.reflectance());
    }
    return all;
}

void SurfaceRenderer::set_reflection(std::size_t index, ReflectionForm form) {
    objects_.at(index).reflection = form;
}

void SurfaceRenderer::set_casts_shadow(std::size_t index, bool casts) {
    objects_.at(index).casts_shadow = casts;
}

const Eigen::Matrix4d& SurfaceRenderer::world_from_model(std::size_t index) const {
    return objects_.at(index).world_from_model;
}

bool SurfaceRenderer::any_reflects(ReflectionForm form) const {
    return std::any_of(objects_.begin(), objects_.end(),
                       [&](const Object& object) { return !object.is_holdout && object.reflection == form; });
}

bool SurfaceRenderer::any_blends() const {
    return std::ranges::any_of(objects_, [](const Object& object) {
        return !object.is_holdout &&
               std::ranges::any_of(object.meshes, [&](const Mesh& mesh) { return object.material_of(mesh).blends(); });
    });
}

bool SurfaceRenderer::any_transmits() const {
    return std::ranges::any_of(objects_, [](const Object& object) {
        return !object.is_holdout && std::ranges::any_of(object.materials, &SurfaceMaterial::transmits);
    });
}

std::size_t SurfaceRenderer::object_count() const {
    return objects_.size();
}

Eigen::AlignedBox3d SurfaceRenderer::object_bounds_m(std::size_t index) const {
    Eigen::AlignedBox3d box;
    const Object& object = objects_.at(index);
    for (const Mesh& mesh : object.meshes) box.extend(object.bounds_of(mesh));
    if (object.is_spheres()) box.extend(sphere_bounds_m(object));
    return box;
}

Eigen::AlignedBox3d SurfaceRenderer::model_bounds_m(std::size_t index) const {
    Eigen::AlignedBox3d box;
    const Object& object = objects_.at(index);
    for (const Mesh& mesh : object.meshes) box.extend(mesh.geometry.bounds_m());
    if (object.is_spheres()) box.extend(spheres_->geometry(*object.spheres).bounds_m());
    return box;
}

Eigen::AlignedBox3d SurfaceRenderer::bounds_m() const {
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < objects_.size(); ++i) box.extend(object_bounds_m(i));
    return box;
}

void SurfaceRenderer::bake_visibility(Program& program) {
    program.use();
    for (Object& object : objects_) {
        const Eigen::Matrix3d linear = object.world_from_model.topLeftCorner<3, 3>();
        program.set("world_from_model", Eigen::Matrix4f(object.world_from_model.cast<float>()));
        program.set("normal_from_model", Eigen::Matrix3f(linear.inverse().transpose().cast<float>()));
        program.set("is_real", object.is_holdout);
        for (Mesh& mesh : object.meshes) mesh.geometry.bake_visibility(program);
    }
}

void SurfaceRenderer::run_over_vertices(Program& program) const {
    program.use();
    for (const Object& object : objects_) {
        const Eigen::Matrix3d linear = object.world_from_model.topLeftCorner<3, 3>();
        program.set("world_from_model", Eigen::Matrix4f(object.world_from_model.cast<float>()));
        program.set("normal_from_model", Eigen::Matrix3f(linear.inverse().transpose().cast<float>()));
        for (const Mesh& mesh : object.meshes) {
            program.set("first_vertex", mesh.first_vertex);
            mesh.geometry.run_over_vertices(program);
        }
    }
}

std::vector<PlacedMesh> SurfaceRenderer::read_meshes() const {
    std::vector<PlacedMesh> placed;
    for (const Object& object : objects_) {
        const Eigen::Matrix3d normal_from_model = object.world_from_model.topLeftCorner<3, 3>().inverse().transpose();
        for (const Mesh& mesh : object.meshes) {
            PlacedMesh& next = placed.emplace_back();
            for (const ModelVertex& vertex : mesh.geometry.read_vertices()) {
                const Eigen::Vector3d position = Eigen::Vector3f(vertex.position.data()).cast<double>();
                const Eigen::Vector3d normal = Eigen::Vector3f(vertex.normal.data()).cast<double>();
                next.positions_m.emplace_back((object.world_from_model * position.homogeneous()).hnormalized());
                next.normals.emplace_back((normal_from_model * normal).normalized());
            }
            next.indices = mesh.geometry.read_indices();
            next.object = static_cast<std::size_t>(&object - objects_.data());
            next.casts_shadow = !object.is_holdout && object.casts(mesh);
            next.is_holdout = object.is_holdout;
            next.reflectance = object.material_of(mesh).reflectance();
        }
    }
    return placed;
}

void SurfaceRenderer::set_visibility(std::size_t mesh, std::span<const Eigen::Vector3f> visibility) {
    for (Object& object : objects_) {
        if (mesh < object.meshes.size()) {
            object.meshes[mesh].geometry.set_visibility(visibility);
            return;
        }
        mesh -= object.meshes.size();
    }
    assert(false);
}

}  // namespace matchlight
