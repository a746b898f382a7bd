// A model's meshes, materials and textures as they lie on the GPU.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gl/objects.h"
#include "gl/program.h"
#include "scene/model.h"
#include "scene/scene_file.h"

namespace matchlight {

/// Vertex attribute 0 is the position, 1 normal, 2 tangent, 3 uv, 4 colour, 5 baked visibility (surface.vert).
class SurfaceMesh {
public:
    explicit SurfaceMesh(const ModelMesh& mesh);
    void draw() const;

    /// Runs effects/object_shadow/bake.comp over the vertices; the result is attribute 5 from then on.
    void bake_visibility(Program& program);
    /// Runs a compute program, 64 vertices a group: binds them (shader storage 0) and what is baked, if anything (1).
    void run_over_vertices(Program& program) const;
    /// RGB for every vertex, instead of what is baked.
    void set_visibility(std::span<const Eigen::Vector3f> visibility);

    /// What was uploaded, read back.
    std::vector<ModelVertex> read_vertices() const;
    std::vector<std::uint32_t> read_indices() const;

    int vertex_count() const { return vertex_count_; }
    const Eigen::AlignedBox3d& bounds_m() const { return bounds_m_; }
    /// Whether the surface encloses space without a gap, every part of it wound outwards: from outside no back face can
    /// be seen, because a ray that has entered nothing has nothing to leave.
    bool is_closed() const { return is_closed_; }

private:
    void attach_visibility();

    Buffer vertices_;
    Buffer indices_;
    VertexArray array_;
    Buffer visibility_;  // empty until baked
    GLsizei vertex_count_ = 0;
    GLsizei index_count_ = 0;
    Eigen::AlignedBox3d bounds_m_;
    bool is_closed_ = false;
};

/// What SurfaceMesh::is_closed says; corners at the very same position count as one.
bool is_closed_outward_surface(const ModelMesh& mesh);

/// Factors and textures of a material, overrides already applied.
struct SurfaceMaterial {
    ModelMaterial factors;  // overrides of the scene applied
    std::array<const Texture2D*, 5>
        textures{};  // base colour, metallic-roughness, normal, occlusion, emissive, or null
    Eigen::Vector3f classic_diffuse = Eigen::Vector3f::Zero();   // Od
    Eigen::Vector3f classic_specular = Eigen::Vector3f::Zero();  // Ks
    bool is_classic = false;  // Od or Ks was chosen; reflection by sphere map is classic all the same

    /// Share of white light that it sends back, diffuse and mirrored together, by its factors.
    float reflectance() const;
    bool blends() const { return factors.alpha_mode == AlphaMode::blend; }
    /// Sets the uniforms and binds the textures (units 0 to 4) of common/material.glsl and the classic terms.
    void bind(Program& program) const;
};

/// The textures of a model, each uploaded once for each way it is read (sRGB or linear).
class SurfaceTextures {
public:
    /// Texture `index` of the model, or null for −1. Throws InputError when it is larger than the driver takes.
    const Texture2D* texture(const Model& model, int index, bool is_srgb);
    /// The same of one that was uploaded; null where it was not.
    const Texture2D* uploaded(int index, bool is_srgb) const;

private:
    struct Entry {
        int index = 0;
        bool is_srgb = false;
        std::unique_ptr<Texture2D> texture;
    };
    std::vector<Entry> entries_;
};

/// The material with what the scene sets in place of the model's values and their textures; Od and Ks aside.
ModelMaterial with_override(const ModelMaterial& material, const MaterialOverride& chosen);

/// `override_` on top of the model's material. Od and Ks of the classic model come from it or, where it has none, from
/// the metallic-roughness factors: Od = base colour · (1 − metallic), Ks = reflectance at normal incidence.
SurfaceMaterial make_surface_material(const Model& model, const ModelMaterial& material, const MaterialOverride& chosen,
                                      SurfaceTextures& textures);
/// The same where all its textures are uploaded already; nullopt where one is not.
std::optional<SurfaceMaterial> surface_material_of_uploaded(const ModelMaterial& material,
                                                            const MaterialOverride& chosen,
                                                            const SurfaceTextures& textures);

}  // namespace matchlight
