// A model's meshes as they lie on the GPU.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "gl/objects.h"
#include "gl/program.h"
#include "scene/model.h"

namespace matchlight {

/// Vertex attribute 0 is the position, 1 normal, 2 tangent, 3 uv, 4 colour, 5 baked visibility, 6 the second uv
/// (surface.vert), 7 and 8 the position at the ends of a way (ways.vert).
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

    /// Other ones, as many.
    void set_vertices(std::span<const ModelVertex> vertices);
    /// Their positions when the shutter opens or closes: attributes 7 and 8.
    void set_way_end(bool closing, std::span<const ModelVertex> vertices);

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
    Buffer visibility_;               // empty until baked
    std::array<Buffer, 2> way_ends_;  // empty unless it deforms
    GLsizei vertex_count_ = 0;
    GLsizei index_count_ = 0;
    Eigen::AlignedBox3d bounds_m_;
    bool is_closed_ = false;
};

/// What SurfaceMesh::is_closed says; corners at the very same position count as one.
bool is_closed_outward_surface(const ModelMesh& mesh);

}  // namespace matchlight
