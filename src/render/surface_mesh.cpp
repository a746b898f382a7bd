// Uploads meshes, binds their vertices.
#include "render/surface_mesh.h"

#include <cassert>
#include <cstddef>

namespace matchlight {

namespace {

Eigen::AlignedBox3d bounds_of(std::span<const ModelVertex> vertices) {
    Eigen::AlignedBox3d box;
    for (const ModelVertex& vertex : vertices) {
        box.extend(Eigen::Vector3d(vertex.position[0], vertex.position[1], vertex.position[2]));
    }
    return box;
}

}  // namespace

SurfaceMesh::SurfaceMesh(const ModelMesh& mesh)
    : vertices_(std::span<const ModelVertex>(mesh.vertices)),
      indices_(std::span<const std::uint32_t>(mesh.indices)),
      vertex_count_(static_cast<GLsizei>(mesh.vertices.size())),
      index_count_(static_cast<GLsizei>(mesh.indices.size())),
      is_closed_(is_closed_outward_surface(mesh)) {
    const VertexArray::Attribute attributes[] = {
        {.location = 0, .components = 3, .byte_offset = offsetof(ModelVertex, position)},
        {.location = 1, .components = 3, .byte_offset = offsetof(ModelVertex, normal)},
        {.location = 2, .components = 4, .byte_offset = offsetof(ModelVertex, tangent)},
        {.location = 3, .components = 2, .byte_offset = offsetof(ModelVertex, uv)},
        {.location = 4, .components = 4, .byte_offset = offsetof(ModelVertex, color)},
        {.location = 6, .components = 2, .byte_offset = offsetof(ModelVertex, uv_second)}};
    array_.set_vertex_buffer(0, vertices_, sizeof(ModelVertex), attributes);
    array_.set_index_buffer(indices_);
    bounds_m_ = bounds_of(mesh.vertices);
}

void SurfaceMesh::set_vertices(std::span<const ModelVertex> vertices) {
    assert(static_cast<GLsizei>(vertices.size()) == vertex_count_);
    vertices_.upload(vertices);
    bounds_m_ = bounds_of(vertices);
}

void SurfaceMesh::set_way_end(bool closing, std::span<const ModelVertex> vertices) {
    assert(static_cast<GLsizei>(vertices.size()) == vertex_count_);
    const GLuint end = closing ? 1 : 0;
    Buffer& buffer = way_ends_.at(end);
    if (buffer.bytes() == 0) {
        buffer = Buffer(vertices.size_bytes());
        const VertexArray::Attribute attribute{
            .location = 7 + end, .components = 3, .byte_offset = offsetof(ModelVertex, position)};
        array_.set_vertex_buffer(2 + end, buffer, sizeof(ModelVertex), {&attribute, 1});
    }
    buffer.upload(vertices);
}

void SurfaceMesh::bake_visibility(Program& program) {
    visibility_ = Buffer(static_cast<std::size_t>(vertex_count_) * 4 * sizeof(float));
    run_over_vertices(program);
    glMemoryBarrier(GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT);
    attach_visibility();
}

void SurfaceMesh::run_over_vertices(Program& program) const {
    vertices_.bind(GL_SHADER_STORAGE_BUFFER, 0);
    if (visibility_.bytes() > 0) visibility_.bind(GL_SHADER_STORAGE_BUFFER, 1);
    static_assert(offsetof(ModelVertex, position) == 0 && offsetof(ModelVertex, normal) == 3 * sizeof(float));
    program.set("vertex_count", vertex_count_);
    program.set("vertex_floats", static_cast<int>(sizeof(ModelVertex) / sizeof(float)));
    constexpr int group = 64;  // as the shaders say
    glDispatchCompute(static_cast<GLuint>((vertex_count_ + group - 1) / group), 1, 1);
}

void SurfaceMesh::attach_visibility() {
    const VertexArray::Attribute attribute{.location = 5, .components = 4, .byte_offset = 0};
    array_.set_vertex_buffer(1, visibility_, 4 * sizeof(float), {&attribute, 1});
}

void SurfaceMesh::set_visibility(std::span<const Eigen::Vector3f> visibility) {
    assert(static_cast<GLsizei>(visibility.size()) == vertex_count_);
    std::vector<float> values;
    for (const Eigen::Vector3f& rgb : visibility) values.insert(values.end(), {rgb.x(), rgb.y(), rgb.z(), 1.0F});
    visibility_ = Buffer(std::span<const float>(values));
    attach_visibility();
}

std::vector<ModelVertex> SurfaceMesh::read_vertices() const {
    std::vector<ModelVertex> vertices(static_cast<std::size_t>(vertex_count_));
    vertices_.read(std::span(vertices));
    return vertices;
}

std::vector<std::uint32_t> SurfaceMesh::read_indices() const {
    std::vector<std::uint32_t> indices(static_cast<std::size_t>(index_count_));
    indices_.read(std::span(indices));
    return indices;
}

void SurfaceMesh::draw() const {
    array_.bind();
    glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace matchlight
