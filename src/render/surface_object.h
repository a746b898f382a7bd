// An object of SurfaceRenderer as it lies on the GPU.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "render/surface.h"
#include "render/surface_material.h"
#include "render/surface_mesh.h"

namespace matchlight {

struct SurfaceRenderer::Mesh {
    SurfaceMesh geometry;
    std::size_t material = 0;
    int first_vertex = 0;  // among those of all meshes
};

struct SurfaceRenderer::Object {
    Eigen::Matrix4d world_from_model;
    ReflectionForm reflection;
    int id;
    bool casts_shadow;
    bool is_holdout;
    SurfaceTextures textures;
    std::vector<ModelMaterial> own_materials;  // as the model has them
    std::vector<SurfaceMaterial> materials;
    std::vector<Mesh> meshes;
    std::optional<std::size_t> spheres = {};  // a set of them instead
    SphereHalo halo = {};
    std::unique_ptr<SurfaceOverlay> overlay = {};  // null: nothing is laid on it

    bool is_spheres() const { return spheres.has_value(); }
    bool has_blending_spheres() const { return is_spheres() && materials.front().blends(); }
    const SurfaceMaterial& material_of(const Mesh& mesh) const { return materials[mesh.material]; }
    bool casts(const Mesh& mesh) const {
        constexpr float solid = 0.5F;
        const SurfaceMaterial& material = material_of(mesh);
        if (material.transmits() && material.factors.transmission->strength > solid) return false;
        return casts_shadow && (!material.blends() || material.factors.base_color[3] >= solid);
    }
    Eigen::AlignedBox3d bounds_of(const Mesh& mesh) const { return placed(mesh.geometry.bounds_m()); }
    Eigen::AlignedBox3d placed(const Eigen::AlignedBox3d& box) const {
        Eigen::AlignedBox3d world;
        for (int i = 0; i < 8; ++i) {
            const Eigen::Vector3d corner = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
            world.extend((world_from_model * corner.homogeneous()).hnormalized());
        }
        return world;
    }
};

}  // namespace matchlight
