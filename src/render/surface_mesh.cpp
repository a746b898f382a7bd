// Uploads meshes and textures, binds materials.
#include "render/surface_mesh.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

#include <fmt/format.h>

#include "core/error.h"
#include "core/transfer.h"
#include "gl/context.h"

namespace matchlight {

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
        {.location = 4, .components = 4, .byte_offset = offsetof(ModelVertex, color)}};
    array_.set_vertex_buffer(0, vertices_, sizeof(ModelVertex), attributes);
    array_.set_index_buffer(indices_);
    for (const ModelVertex& vertex : mesh.vertices) {
        bounds_m_.extend(Eigen::Vector3d(vertex.position[0], vertex.position[1], vertex.position[2]));
    }
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

float SurfaceMaterial::reflectance() const {
    const auto& base = factors.base_color;
    const double luminance = luminance_rec709(base[0], base[1], base[2]);
    constexpr double dielectric = 0.04;  // glTF 2.0, appendix B
    return static_cast<float>(std::clamp(luminance + dielectric * (1 - factors.metallic), 0.0, 1.0));
}

void SurfaceMaterial::bind(Program& program) const {
    int present = 0;
    for (std::size_t i = 0; i < textures.size(); ++i) {
        if (!textures[i]) continue;
        textures[i]->bind(static_cast<GLuint>(i));
        present |= 1 << i;
    }
    program.set("material_textures", present);
    program.set("base_color_factor", Eigen::Vector4f(factors.base_color.data()));
    program.set("metallic_factor", factors.metallic);
    program.set("roughness_factor", factors.roughness);
    program.set("emissive_factor", Eigen::Vector3f(factors.emissive.data()));
    program.set("normal_scale", factors.normal_scale);
    program.set("occlusion_strength", factors.occlusion_strength);
    program.set("alpha_cutoff", factors.alpha_mode == AlphaMode::mask ? factors.alpha_cutoff : 0.0F);
    program.set("alpha_blends", blends());
    program.set("classic_diffuse", classic_diffuse);
    program.set("classic_specular", classic_specular);
    program.set("is_classic", is_classic);
}

const Texture2D* SurfaceTextures::uploaded(int index, bool is_srgb) const {
    const auto known = std::ranges::find_if(
        entries_, [&](const Entry& entry) { return entry.index == index && entry.is_srgb == is_srgb; });
    return known != entries_.end() ? known->texture.get() : nullptr;
}

const Texture2D* SurfaceTextures::texture(const Model& model, int index, bool is_srgb) {
    if (index < 0) return nullptr;
    if (const Texture2D* known = uploaded(index, is_srgb)) return known;
    const ModelTexture& source = model.textures.at(static_cast<std::size_t>(index));
    const Image8& image = source.rgba;
    const int largest = current_gl_context()->info().max_texture_size;
    if (image.width() > largest || image.height() > largest) {
        throw InputError(source.name, fmt::format("the texture has {}×{} pixels; this OpenGL driver takes {}",
                                                  image.width(), image.height(), largest));
    }
    auto texture =
        std::make_unique<Texture2D>(TextureShape{.format = is_srgb ? GLenum{GL_SRGB8_ALPHA8} : GLenum{GL_RGBA8},
                                                 .width = image.width(),
                                                 .height = image.height(),
                                                 .levels = 0});
    texture->upload(image);
    texture->make_mipmaps();
    texture->set_filter(Filter::trilinear);
    texture->set_wrap(source.wrap_repeat_u ? Wrap::repeat : Wrap::clamp_to_edge,
                      source.wrap_repeat_v ? Wrap::repeat : Wrap::clamp_to_edge);
    entries_.push_back({index, is_srgb, std::move(texture)});
    return entries_.back().texture.get();
}

namespace {

std::array<float, 3> to_float(const std::array<double, 3>& value) {
    return {static_cast<float>(value[0]), static_cast<float>(value[1]), static_cast<float>(value[2])};
}

}  // namespace

ModelMaterial with_override(const ModelMaterial& material, const MaterialOverride& chosen) {
    ModelMaterial factors = material;
    // A value the scene sets replaces the model's, its texture included.
    if (chosen.base_color) {
        const auto rgb = to_float(*chosen.base_color);
        std::copy(rgb.begin(), rgb.end(), factors.base_color.begin());
        if (chosen.texture.empty()) factors.base_color_texture = -1;
    }
    if (chosen.metallic || chosen.roughness) {
        factors.metallic = static_cast<float>(chosen.metallic.value_or(factors.metallic));
        factors.roughness = static_cast<float>(chosen.roughness.value_or(factors.roughness));
        factors.metallic_roughness_texture = -1;
    }
    if (chosen.emissive) {
        factors.emissive = to_float(*chosen.emissive);
        factors.emissive_texture = -1;
    }
    return factors;
}

namespace {

/// `texture_of(index, is_srgb)` of each texture that is left of the model's.
template <class TextureOf>
SurfaceMaterial surface_material(const ModelMaterial& material, const MaterialOverride& chosen,
                                 const TextureOf& texture_of) {
    SurfaceMaterial result;
    result.factors = with_override(material, chosen);
    const ModelMaterial& factors = result.factors;
    result.textures = {texture_of(factors.base_color_texture, true),
                       texture_of(factors.metallic_roughness_texture, false), texture_of(factors.normal_texture, false),
                       texture_of(factors.occlusion_texture, false), texture_of(factors.emissive_texture, true)};
    const Eigen::Vector3f base(factors.base_color.data());
    constexpr float dielectric_reflectance = 0.04F;  // glTF 2.0, appendix B
    const Eigen::Vector3f reflectance =
        Eigen::Vector3f::Constant(dielectric_reflectance * (1 - factors.metallic)) + factors.metallic * base;
    result.classic_diffuse = chosen.diffuse ? Eigen::Vector3f(to_float(*chosen.diffuse).data())
                                            : Eigen::Vector3f((1 - factors.metallic) * base);
    result.is_classic = chosen.diffuse || chosen.specular;
    result.classic_specular = chosen.specular ? Eigen::Vector3f(to_float(*chosen.specular).data()) : reflectance;
    return result;
}

}  // namespace

SurfaceMaterial make_surface_material(const Model& model, const ModelMaterial& material, const MaterialOverride& chosen,
                                      SurfaceTextures& textures) {
    return surface_material(material, chosen,
                            [&](int index, bool is_srgb) { return textures.texture(model, index, is_srgb); });
}

std::optional<SurfaceMaterial> surface_material_of_uploaded(const ModelMaterial& material,
                                                            const MaterialOverride& chosen,
                                                            const SurfaceTextures& textures) {
    bool all_there = true;
    SurfaceMaterial result = surface_material(material, chosen, [&](int index, bool is_srgb) {
        const Texture2D* texture = textures.uploaded(index, is_srgb);
        all_there = all_there && (index < 0 || texture != nullptr);
        return texture;
    });
    return all_there ? std::optional(std::move(result)) : std::nullopt;
}

}  // namespace matchlight
