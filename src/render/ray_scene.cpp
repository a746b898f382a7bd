// Packs trees, triangles and vertices of all meshes into one buffer each.
#include "render/ray_scene.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <span>

#include "core/transfer.h"
#include "render/surface_material.h"
#include "render/surface_mesh.h"

namespace matchlight {

namespace {

/// Of both transforms of a mesh, as common/rays.glsl reads them.
constexpr int rows = 6;

/// What lets more than this pass is seen through rather than seen.
constexpr float least_transmission = 0.5F;

float bits(std::uint32_t value) {
    return std::bit_cast<float>(value);
}

/// The nearest texel, as the texture's wrapping has it; 0..1.
std::array<float, 4> texel_at(const ModelTexture& texture, const std::array<float, 2>& uv) {
    const auto place = [](float coordinate, int size, TextureWrap wrap) {
        if (!std::isfinite(coordinate)) return 0;
        float wrapped = std::clamp(coordinate, 0.0F, 1.0F);
        if (wrap == TextureWrap::repeat) wrapped = coordinate - std::floor(coordinate);
        if (wrap == TextureWrap::mirror) wrapped = std::abs(coordinate - 2 * std::floor((coordinate + 1) / 2));
        return std::min(static_cast<int>(wrapped * static_cast<float>(size)), size - 1);
    };
    const std::uint8_t* texel = texture.rgba.pixel(place(uv[0], texture.rgba.width(), texture.sampling.wrap_u),
                                                   place(uv[1], texture.rgba.height(), texture.sampling.wrap_v));
    constexpr float white = 255;
    return {texel[0] / white, texel[1] / white, texel[2] / white, texel[3] / white};
}

Eigen::Vector3f linear_of(const std::array<float, 4>& srgb) {
    Eigen::Vector3f linear;
    for (int channel = 0; channel < 3; ++channel) {
        linear[channel] = static_cast<float>(linear_from_srgb_code(srgb.at(static_cast<std::size_t>(channel))));
    }
    return linear;
}

}  // namespace

void RayScene::add_object(const Model& model, const MaterialOverride& material, bool is_holdout) {
    const ModelMaterial none;
    for (const ModelMesh& mesh : model.meshes) {
        if (mesh.indices.empty()) continue;
        const ModelMaterial& own =
            model.materials.empty() ? none : model.materials.at(static_cast<std::size_t>(std::max(mesh.material, 0)));
        const ModelMaterial factors = with_override(own, material);
        const auto texture = [&](int index) {
            return index < 0 ? nullptr : &model.textures.at(static_cast<std::size_t>(index));
        };
        const ModelTexture* base_texture = texture(factors.texture(MaterialSlot::base_color));
        const ModelTexture* rough_texture = texture(factors.texture(MaterialSlot::metallic_roughness));
        const ModelTexture* emissive_texture = texture(factors.texture(MaterialSlot::emissive));
        const auto uv_of = [&](const ModelVertex& vertex, MaterialSlot slot) {
            return factors.use(slot).mapping(vertex.uv, vertex.uv_second);
        };
        const auto first_vertex = static_cast<int>(vertices_.size());
        for (const ModelVertex& vertex : mesh.vertices) {
            Eigen::Vector3f base =
                Eigen::Vector3f(factors.base_color.data()).cwiseProduct(Eigen::Vector3f(vertex.color.data()));
            if (base_texture)
                base = base.cwiseProduct(linear_of(texel_at(*base_texture, uv_of(vertex, MaterialSlot::base_color))));
            Eigen::Vector2f metallic_roughness(factors.metallic, factors.roughness);
            if (rough_texture) {
                const std::array<float, 4> texel =
                    texel_at(*rough_texture, uv_of(vertex, MaterialSlot::metallic_roughness));
                metallic_roughness = metallic_roughness.cwiseProduct(Eigen::Vector2f(texel[2], texel[1]));
            }
            Eigen::Vector3f emission(factors.emissive.data());
            if (emissive_texture)
                emission = emission.cwiseProduct(
                    linear_of(texel_at(*emissive_texture, uv_of(vertex, MaterialSlot::emissive))));
            const Eigen::Vector3f normal(vertex.normal.data());
            vertices_.push_back({.normal_roughness = {normal.x(), normal.y(), normal.z(), metallic_roughness.y()},
                                 .base_metallic = {base.x(), base.y(), base.z(), metallic_roughness.x()}});
            emission_.push_back({emission.x(), emission.y(), emission.z(), 0.0F});
        }
        if (mesh.binding) {
            bound_.push_back({.object = objects_,
                              .mesh = static_cast<std::size_t>(&mesh - model.meshes.data()),
                              .first_vertex = static_cast<std::size_t>(first_vertex),
                              .tree = {}});
        }
        const bool shows_behind = factors.alpha_mode == AlphaMode::blend ||
                                  (factors.transmission && factors.transmission->strength > least_transmission);
        if (shows_behind && !is_holdout) continue;
        const bool is_closed = is_closed_outward_surface(mesh);
        const TriangleTree tree = make_triangle_tree(mesh.vertices, mesh.indices);
        const auto first_node = static_cast<int>(nodes_.size() / 2);
        placed_.push_back({.object = objects_,
                           .first_node = first_node,
                           .end_node = first_node + static_cast<int>(tree.nodes.size()),
                           .first_triangle = static_cast<int>(triangles_.size()),
                           .vertices = is_holdout ? -1 : 2 * first_vertex + (is_closed ? 1 : 0)});
        for (const TriangleTreeNode& node : tree.nodes) append_node(node, static_cast<std::size_t>(first_node), nodes_);
        if (mesh.binding) {
            bound_.back().first_node = static_cast<std::size_t>(first_node);
            bound_.back().first_triangle = triangles_.size();
            bound_.back().tree = tree;
        }
        for (const TreeTriangle& triangle : tree.triangles) triangles_.push_back(corners_of(triangle, mesh.vertices));
    }
    ++objects_;
}

void RayScene::add_spheres(const SphereSet& set, const MaterialOverride& material) {
    const std::size_t object = objects_++;
    if (!meets(set) || set.spheres.empty()) return;
    const ModelMaterial factors = with_override({}, material);
    const Eigen::Vector3f factor(factors.base_color.data());
    const TriangleTree tree = make_sphere_tree(set.spheres);
    const auto first_node = static_cast<int>(nodes_.size() / 2);
    placed_sets_.push_back({.object = object,
                            .first_node = first_node,
                            .end_node = first_node + static_cast<int>(tree.nodes.size()),
                            .first_triangle = static_cast<int>(triangles_.size())});
    set_vertices_.push_back({{.normal_roughness = {0, 0, 0, factors.roughness},
                              .base_metallic = {factor.x(), factor.y(), factor.z(), factors.metallic}},
                             {factors.emissive[0], factors.emissive[1], factors.emissive[2], 0}});
    for (const TriangleTreeNode& node : tree.nodes) append_node(node, static_cast<std::size_t>(first_node), nodes_);
    for (const TreeTriangle& leaf : tree.triangles) {
        const std::uint32_t number = leaf.corners[0];
        const auto& [centre, radius] = set.spheres[number];
        Eigen::Vector3f color(set.color.data());
        if (!set.colors.empty()) {
            const auto& code = set.colors[number];
            constexpr float white = 255;
            color = linear_of({code[0] / white, code[1] / white, code[2] / white, 1});
        }
        color = color.cwiseProduct(factor);
        triangles_.push_back(
            {{centre[0], centre[1], centre[2], radius}, {color.x(), color.y(), color.z(), 0}, {0, 0, 0, 0}});
    }
}

void RayScene::append_node(const TriangleTreeNode& node, std::size_t first_node, std::vector<Float4>& to) {
    const auto skip = static_cast<std::uint32_t>(first_node) + static_cast<std::uint32_t>(node.skip);
    to.push_back({node.low[0], node.low[1], node.low[2], bits(skip)});
    to.push_back({node.high[0], node.high[1], node.high[2], bits(node.leaf)});
}

RayScene::Triangle RayScene::corners_of(const TreeTriangle& triangle, std::span<const ModelVertex> vertices) {
    const auto corner = [&](std::size_t i) {
        return Eigen::Vector3f(vertices[triangle.corners.at(i)].position.data());
    };
    const auto with_bits = [&](const Eigen::Vector3f& xyz, std::size_t i) {
        return Float4{xyz.x(), xyz.y(), xyz.z(), bits(triangle.corners.at(i))};
    };
    return {with_bits(corner(0), 0), with_bits(corner(1) - corner(0), 1), with_bits(corner(2) - corner(0), 2)};
}

void RayScene::deform_object(std::size_t index, std::span<const ModelMesh> meshes) {
    for (Bound& bound : bound_) {
        if (bound.object != index) continue;
        const std::vector<ModelVertex>& vertices = meshes[bound.mesh].vertices;
        const std::span<Vertex> own = std::span(vertices_).subspan(bound.first_vertex, vertices.size());
        for (std::size_t i = 0; i < vertices.size(); ++i)
            std::ranges::copy(vertices[i].normal, own[i].normal_roughness.begin());
        vertex_texels_.buffer.upload(std::span<const Vertex>(own), bound.first_vertex * sizeof(Vertex));
        if (bound.tree.nodes.empty()) continue;
        refit(bound.tree, vertices);
        std::vector<Float4> nodes;
        for (const TriangleTreeNode& node : bound.tree.nodes) append_node(node, bound.first_node, nodes);
        std::vector<Triangle> triangles;
        for (const TreeTriangle& triangle : bound.tree.triangles) triangles.push_back(corners_of(triangle, vertices));
        node_texels_.buffer.upload(std::span<const Float4>(nodes), 2 * bound.first_node * sizeof(Float4));
        triangle_texels_.buffer.upload(std::span<const Triangle>(triangles), bound.first_triangle * sizeof(Triangle));
    }
}

void RayScene::finish() {
    if (vertices_.empty()) return;
    for (std::size_t i = 0; i < set_vertices_.size(); ++i) {
        placed_sets_[i].vertices = 2 * static_cast<int>(vertices_.size());
        vertices_.push_back(set_vertices_[i].vertex);
        emission_.push_back(set_vertices_[i].emission);
    }
    const auto fetched = [](Buffer buffer, GLenum format) {
        Fetched texels{std::move(buffer), {}};
        texels.texture = BufferTexture(texels.buffer, format);
        return texels;
    };
    vertex_texels_ = fetched(Buffer(std::span<const Vertex>(vertices_)), GL_RGBA32F);
    const std::size_t bytes = emission_.size() * sizeof(Float4);
    light_ = {.emission = Buffer(std::span<const Float4>(emission_)),
              .direct = Buffer(bytes),
              .bounced = Buffer(bytes),
              .radiosity = Buffer(bytes)};
    radiosity_texels_ = BufferTexture(light_.radiosity, GL_RGBA32F);
    emission_texels_ = BufferTexture(light_.emission, GL_RGBA32F);
    bounced_texels_ = BufferTexture(light_.bounced, GL_RGBA32F);
    if (placed_.empty()) return;
    node_texels_ = fetched(Buffer(std::span<const Float4>(nodes_)), GL_RGBA32UI);
    triangle_texels_ = fetched(Buffer(std::span<const Triangle>(triangles_)), GL_RGBA32UI);
    instance_texels_ = fetched(Buffer((placed_.size() + placed_sets_.size()) * rows * sizeof(Float4)), GL_RGBA32F);
    std::vector<std::int32_t> ranges;
    for (const std::vector<PlacedMesh>* placed : {&placed_, &placed_sets_}) {
        for (const PlacedMesh& mesh : *placed)
            ranges.insert(ranges.end(), {mesh.first_node, mesh.end_node, mesh.first_triangle, mesh.vertices});
    }
    range_texels_ = fetched(Buffer(std::span<const std::int32_t>(ranges)), GL_RGBA32I);
    // On the GPU now.
    nodes_ = {};
    triangles_ = {};
    emission_ = {};
}

void RayScene::place(const std::vector<Eigen::Matrix4d>& world_from_model) {
    assert(world_from_model.size() == objects_);
    if (placed_.empty()) return;
    std::vector<Float4> placements;
    const auto place = [&](const Eigen::Matrix4d& placement) {
        for (const Eigen::Matrix4f& matrix :
             {Eigen::Matrix4f(placement.cast<float>()), Eigen::Matrix4f(placement.inverse().cast<float>())}) {
            for (int row = 0; row < rows / 2; ++row)
                placements.push_back({matrix(row, 0), matrix(row, 1), matrix(row, 2), matrix(row, 3)});
        }
    };
    for (const PlacedMesh& mesh : placed_) place(world_from_model[mesh.object]);
    for (const PlacedMesh& set : placed_sets_) place(world_from_model[set.object]);
    instance_texels_.buffer.upload(std::span<const Float4>(placements));
}

void RayScene::bind(Program& program) const {
    program.set("ray_instance_count", static_cast<int>(placed_.size()));
    program.set("ray_sphere_set_count", static_cast<int>(placed_sets_.size()));
    GLuint unit = first_texture_unit;
    const auto bind_next = [&](const char* sampler, const BufferTexture& texels) {
        program.bind_texture(sampler, unit++, texels);
    };
    bind_next("ray_nodes", node_texels_.texture);
    bind_next("ray_triangles", triangle_texels_.texture);
    bind_next("ray_instances", instance_texels_.texture);
    bind_next("ray_ranges", range_texels_.texture);
    bind_next("ray_vertices", vertex_texels_.texture);
    bind_next("ray_radiosity", radiosity_texels_);
    bind_next("ray_emission", emission_texels_);
    bind_next("ray_bounced", bounced_texels_);
}

}  // namespace matchlight
