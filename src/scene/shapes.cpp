// The built-in shapes: surfaces with analytic normals, laid out as grids.
#include <cmath>
#include <functional>
#include <numbers>

#include <fmt/format.h>

#include "core/error.h"
#include "scene/mesh_geometry.h"
#include "scene/model.h"
#include "scene/scene_schema.h"

namespace matchlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct SurfacePoint {
    Vector3d position;
    Vector3d normal;
    Vector2d uv;
};
/// A point of a surface over the unit square; seen from outside, u grows to the right and v downwards.
using Surface = std::function<SurfacePoint(double u, double v)>;

void add_surface(ModelMesh& mesh, int columns, int rows, const Surface& surface) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int row = 0; row <= rows; ++row) {
        for (int column = 0; column <= columns; ++column) {
            const SurfacePoint point = surface(static_cast<double>(column) / columns, static_cast<double>(row) / rows);
            const Eigen::Vector3f position = point.position.cast<float>();
            const Eigen::Vector3f normal = point.normal.cast<float>();
            const Eigen::Vector2f uv = point.uv.cast<float>();
            mesh.vertices.push_back({.position = {position.x(), position.y(), position.z()},
                                     .normal = {normal.x(), normal.y(), normal.z()},
                                     .tangent = {0, 0, 0, 0},
                                     .uv = {uv.x(), uv.y()},
                                     .color = {1, 1, 1, 1}});
        }
    }
    const auto stride = static_cast<std::uint32_t>(columns + 1);
    for (std::uint32_t row = 0; row < static_cast<std::uint32_t>(rows); ++row) {
        for (std::uint32_t column = 0; column < static_cast<std::uint32_t>(columns); ++column) {
            const std::uint32_t top_left = first + row * stride + column;
            const std::uint32_t bottom_left = top_left + stride;
            const std::uint32_t corners[] = {top_left, bottom_left,     bottom_left + 1,
                                             top_left, bottom_left + 1, top_left + 1};
            mesh.indices.insert(mesh.indices.end(), std::begin(corners), std::end(corners));
        }
    }
}

/// Unit vector at `turn` (0 to 1) counter-clockwise seen from above; exact where the seam closes.
Vector3d around(double turn) {
    const double angle = 2 * std::numbers::pi * (turn == 1 ? 0 : turn);
    return {std::cos(angle), std::sin(angle), 0};
}

// Silhouettes of this many straight pieces leave a circle of 200 pixels radius by 0.03 pixels.
constexpr int pieces_around = 192;

void add_sphere(ModelMesh& mesh) {
    add_surface(mesh, pieces_around, pieces_around / 2, [](double u, double v) {
        const double polar = std::numbers::pi * v;
        const double sine = v == 0 || v == 1 ? 0 : std::sin(polar);
        const Vector3d normal = around(u) * sine + Vector3d::UnitZ() * std::cos(polar);
        return SurfacePoint{normal / 2, normal, {u, v}};
    });
}

void add_plane(ModelMesh& mesh) {
    add_surface(mesh, 1, 1, [](double u, double v) {
        return SurfacePoint{{u - 0.5, 0.5 - v, 0}, Vector3d::UnitZ(), {u, v}};
    });
}

void add_box(ModelMesh& mesh) {
    const Vector3d x = Vector3d::UnitX();
    const Vector3d y = Vector3d::UnitY();
    const Vector3d z = Vector3d::UnitZ();
    // Right and up of each side as seen from outside; their cross product points out.
    struct Side {
        Vector3d right, up;
    };
    const Side sides[] = {{x, z}, {y, z}, {-x, z}, {-y, z}, {x, y}, {x, -y}};
    for (const Side& side : sides) {
        add_surface(mesh, 1, 1, [&](double u, double v) {
            const Vector3d out = side.right.cross(side.up);
            return SurfacePoint{out / 2 + side.right * (u - 0.5) + side.up * (0.5 - v), out, {u, v}};
        });
    }
}

void add_torus(ModelMesh& mesh) {
    constexpr double major_radius = 0.35;
    constexpr double minor_radius = 0.15;
    add_surface(mesh, pieces_around, pieces_around / 2, [&](double u, double v) {
        const double angle = -2 * std::numbers::pi * (v == 1 ? 0 : v);
        const Vector3d normal = around(u) * std::cos(angle) + Vector3d::UnitZ() * std::sin(angle);
        return SurfacePoint{around(u) * major_radius + normal * minor_radius, normal, {u, v}};
    });
}

void add_cylinder(ModelMesh& mesh) {
    const Vector3d z = Vector3d::UnitZ();
    const auto disc_uv = [](const Vector3d& p, double up) { return Vector2d(0.5 + p.x(), 0.5 - up * p.y()); };
    add_surface(mesh, pieces_around, 1, [&](double u, double v) {
        return SurfacePoint{around(u) / 2 + z * (0.5 - v), around(u), {u, v}};
    });
    add_surface(mesh, pieces_around, 1, [&](double u, double v) {
        const Vector3d p = around(u) * (v / 2);
        return SurfacePoint{p + z / 2, z, disc_uv(p, 1)};
    });
    add_surface(mesh, pieces_around, 1, [&](double u, double v) {
        const Vector3d p = around(u) * ((1 - v) / 2);
        return SurfacePoint{p - z / 2, -z, disc_uv(p, -1)};
    });
}

struct Shape {
    std::string_view name;
    void (*add)(ModelMesh&);
};
constexpr Shape shapes[] = {
    {"sphere", add_sphere}, {"box", add_box}, {"plane", add_plane}, {"torus", add_torus}, {"cylinder", add_cylinder}};

}  // namespace

Model make_shape(const std::string& shape, const std::filesystem::path& reported) {
    std::vector<std::string_view> names;
    for (const Shape& candidate : shapes) {
        names.push_back(candidate.name);
        if (candidate.name != shape) continue;
        Model model;
        model.name = shape;
        ModelMesh& mesh = model.meshes.emplace_back();
        candidate.add(mesh);
        drop_bad_triangles(mesh);  // at the poles
        compute_tangents(mesh);
        weld(mesh);
        ModelMaterial& material = model.materials.emplace_back();
        material.name = shape;
        material.double_sided = shape == "plane";  // it has no inside
        model.update_bounds();
        return model;
    }
    throw InputError(reported, fmt::format("unknown shape '{}'", shape),
                     fmt::format("did you mean '{}'?", nearest_word(shape, names)));
}

}  // namespace matchlight
