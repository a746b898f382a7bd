// The virtual objects as rays meet them on the GPU: shaders/common/rays.glsl walks what this class uploads.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "gl/objects.h"
#include "gl/program.h"
#include "scene/model.h"
#include "scene/scene_file.h"
#include "scene/triangle_tree.h"

namespace matchlight {

/// Each mesh has a hierarchy in its model's own axes, so that an object that moves needs no other. Blended meshes and
/// those that transmit are not met: most of what they let through would be lost. Vertices are numbered over all meshes
/// of all objects in the order in which they were added, blended ones included, as SurfaceRenderer numbers them.
class RayScene {
public:
    /// `model` is only read while adding. Base colour, metallic, roughness and emission are taken at the vertices. A
    /// holdout is a real thing: rays that meet it see of it what the probe saw.
    void add_object(const Model& model, const MaterialOverride& material, bool is_holdout);
    /// A set of spheres, each met as a sphere; see meets(). Programs meet them that are compiled with RAY_SPHERES.
    void add_spheres(const SphereSet& set, const MaterialOverride& material);
    /// Sets that let light through are not met, as blended meshes are not, nor those of which there are more than this.
    static bool meets(const SphereSet& set) { return !set.blends() && set.size() <= most_spheres; }
    static constexpr std::size_t most_spheres = std::size_t{1} << 20;
    /// Uploads what was added, and makes room for light at the vertices.
    void finish();
    /// Where the objects stand, in the order they were added; before the first ray and after every change.
    void place(const std::vector<Eigen::Matrix4d>& world_from_model);

    /// Moves the vertices of the meshes of an object's model that are bound to a rig, after finish(); `meshes` are all
    /// of them.
    void deform_object(std::size_t index, std::span<const ModelMesh> meshes);

    /// Spheres alone are not worth a ray: it is models that show them.
    bool empty() const { return placed_.empty(); }
    bool has_spheres() const { return !placed_sets_.empty(); }
    std::size_t vertex_count() const { return vertices_.size(); }

    /// Sets the uniforms of common/rays.glsl and those of the light at the vertices, `ray_radiosity`, `ray_emission`
    /// and `ray_bounced`; takes eight texture units from `first_texture_unit`.
    void bind(Program& program) const;
    static constexpr GLuint first_texture_unit = 17;

    /// Light at the vertices, RGBA32F each, in probe units; filled by render/effects/bounce_light.h.
    struct VertexLight {
        Buffer emission;   // radiance
        Buffer direct;     // irradiance over π that arrives from the probe
        Buffer bounced;    // irradiance over π that arrives from other objects
        Buffer radiosity;  // radiance that leaves diffusely, emission included
    };
    const VertexLight& light() const { return light_; }

private:
    // As the shaders fetch them.
    using Float4 = std::array<float, 4>;
    struct Vertex {
        Float4 normal_roughness, base_metallic;
    };
    struct Triangle {
        Float4 corner, edge1, edge2;
    };
    struct PlacedMesh {
        std::size_t object = 0;
        int first_node = 0, end_node = 0, first_triangle = 0;
        int vertices = 0;  // the first one's number · 2 + whether it is a closed surface; −1: a holdout
    };

    /// A mesh whose vertices move.
    struct Bound {
        std::size_t object = 0, mesh = 0;  // the mesh's number in its model
        std::size_t first_vertex = 0, first_node = 0, first_triangle = 0;
        TriangleTree tree;  // empty where rays do not meet it
    };
    static void append_node(const TriangleTreeNode& node, std::size_t first_node, std::vector<Float4>& to);
    static Triangle corners_of(const TreeTriangle& triangle, std::span<const ModelVertex> vertices);

    std::size_t objects_ = 0;
    std::vector<Bound> bound_;
    std::vector<Vertex> vertices_;
    std::vector<Float4> emission_;
    std::vector<Float4> nodes_;  // two a node
    std::vector<Triangle> triangles_;
    std::vector<PlacedMesh> placed_;
    std::vector<PlacedMesh> placed_sets_;  // of spheres: the vertex has what all of a set have in common
    struct CommonVertex {
        Vertex vertex;
        Float4 emission;
    };
    std::vector<CommonVertex> set_vertices_;  // come after those of all meshes
    struct Fetched {
        Buffer buffer;
        BufferTexture texture;
    };
    Fetched node_texels_, triangle_texels_, instance_texels_, range_texels_, vertex_texels_;
    BufferTexture radiosity_texels_, emission_texels_, bounced_texels_;
    VertexLight light_;
};

}  // namespace matchlight
