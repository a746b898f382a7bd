// Uploads a set piece by piece, so that no second copy of it is held.
#include "render/sphere_geometry.h"

#include <algorithm>
#include <array>
#include <span>

#include <fmt/format.h>

#include "core/error.h"

namespace matchlight {

namespace {

/// Many enough for a draw, few enough for what hides a part of them to tell; and no more cells than the CPU can look at
/// in every frame.
std::size_t most_in_cell(std::size_t spheres) {
    constexpr std::size_t fewest = 256, most = 2048, cells = 1 << 15;
    return std::clamp(spheres / cells, fewest, most);
}

/// Copies `values` in another order.
template <class Value>
Buffer in_order(std::span<const Value> values, std::span<const std::uint32_t> order) {
    Buffer buffer(order.size() * sizeof(Value));
    constexpr std::size_t piece = 1 << 18;
    std::vector<Value> sorted;
    for (std::size_t first = 0; first < order.size(); first += piece) {
        sorted.clear();
        for (const std::uint32_t i : order.subspan(first, std::min(piece, order.size() - first))) {
            sorted.push_back(values[i]);
        }
        buffer.upload(std::span<const Value>(sorted), first * sizeof(Value));
    }
    return buffer;
}

}  // namespace

SphereGeometry::SphereGeometry(const SphereSet& set)
    : size_(static_cast<std::uint32_t>(set.size())), bounds_m_(set.bounds_m) {
    GLint most = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
    if (set.size() > static_cast<std::size_t>(most)) {
        throw InputError(set.name,
                         fmt::format("{} spheres are more than the {} that this driver holds", set.size(), most),
                         "split the set into several objects");
    }
    if (set.spheres.empty()) return;
    SphereCells sorted = sphere_cells(set, most_in_cell(set.size()));
    cells_ = std::move(sorted.cells);
    spheres_ = in_order(std::span<const Sphere>(set.spheres), sorted.order);
    sphere_texels_ = BufferTexture(spheres_, GL_RGBA32F);
    const VertexArray::Attribute centre_radius{.location = 0, .components = 4, .byte_offset = 0};
    points_.set_vertex_buffer(0, spheres_, sizeof(Sphere), std::span(&centre_radius, 1));
    std::array<float, most_detail_level + 1> scales{};
    for (int level = 0; level <= most_detail_level; ++level)
        scales.at(static_cast<std::size_t>(level)) = static_cast<float>(radius_scale(level));
    radius_scales_ = Buffer(sizeof(scales));
    radius_scales_.upload(std::span<const float>(scales));
    const VertexArray::Attribute scale{.location = 1, .components = 1, .byte_offset = 0};
    points_.set_vertex_buffer(1, radius_scales_, sizeof(float), std::span(&scale, 1), 1);
    has_colors_ = !set.colors.empty();
    if (has_colors_) {
        colors_ = in_order(std::span<const std::array<std::uint8_t, 4>>(set.colors), sorted.order);
        color_texels_ = BufferTexture(colors_, GL_RGBA8);
    }
    has_opacities_ = !set.opacities.empty();
    if (has_opacities_) {
        opacities_ = in_order(std::span<const float>(set.opacities), sorted.order);
        opacity_texels_ = BufferTexture(opacities_, GL_R32F);
    }
}

void SphereGeometry::bind(Program& program) const {
    sphere_texels_.bind(sphere_geometry_unit);
    program.set("spheres", static_cast<int>(sphere_geometry_unit));
    (has_colors_ ? color_texels_ : sphere_texels_).bind(sphere_geometry_unit + 1);
    program.set("sphere_colors", static_cast<int>(sphere_geometry_unit + 1));
    program.set("has_sphere_colors", has_colors_);
    (has_opacities_ ? opacity_texels_ : sphere_texels_).bind(sphere_geometry_unit + 2);
    program.set("sphere_opacities", static_cast<int>(sphere_geometry_unit + 2));
    program.set("has_sphere_opacities", has_opacities_);
}

}  // namespace matchlight
