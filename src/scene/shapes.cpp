// The built-in shapes: surfaces with analytic normals, laid out as grids.
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/error.h"
#include "scene/mesh_geometry.h"
#include "scene/model.h"
#include "scene/scene_schema.h"
#include "scene/surface_grid.h"
#include "scene/teapot.h"

namespace matchlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Unit vector at `turn` (0 to 1) counter-clockwise seen from above; exact where the seam closes.
Vector3d around(double turn) {
    const double angle = 2 * std::numbers::pi * (turn == 1 ? 0 : turn);
    return {std::cos(angle), std::sin(angle), 0};
}

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

/// Of a disc across the z axis, seen from above (`up` = 1) or below (−1).
Vector2d disc_uv(const Vector3d& p, double up) {
    return {0.5 + p.x(), 0.5 - up * p.y()};
}

void add_bottom(ModelMesh& mesh) {
    add_surface(mesh, pieces_around, 1, [](double u, double v) {
        const Vector3d p = around(u) * ((1 - v) / 2);
        return SurfacePoint{p - Vector3d::UnitZ() / 2, -Vector3d::UnitZ(), disc_uv(p, -1)};
    });
}

void add_cylinder(ModelMesh& mesh) {
    const Vector3d z = Vector3d::UnitZ();
    add_surface(mesh, pieces_around, 1, [&](double u, double v) {
        return SurfacePoint{around(u) / 2 + z * (0.5 - v), around(u), {u, v}};
    });
    add_surface(mesh, pieces_around, 1, [&](double u, double v) {
        const Vector3d p = around(u) * (v / 2);
        return SurfacePoint{p + z / 2, z, disc_uv(p, 1)};
    });
    add_bottom(mesh);
}

void add_cone(ModelMesh& mesh) {
    const Vector3d z = Vector3d::UnitZ();
    add_surface(mesh, pieces_around, 1, [&](double u, double v) {
        // Across a side that falls by 1 while it goes out by ½.
        return SurfacePoint{around(u) * (v / 2) + z * (0.5 - v), (around(u) + z / 2).normalized(), {u, v}};
    });
    add_bottom(mesh);
}

struct Shape {
    std::string_view name;
    void (*add)(ModelMesh&);
};
constexpr Shape shapes[] = {{"sphere", add_sphere},     {"box", add_box},   {"plane", add_plane},  {"torus", add_torus},
                            {"cylinder", add_cylinder}, {"cone", add_cone}, {"teapot", add_teapot}};

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
        material.double_sided = shape == "plane" || shape == "teapot";  // no inside; a spout to look into
        model.update_bounds();
        return model;
    }
    throw InputError(reported, fmt::format("unknown shape '{}'", shape),
                     fmt::format("did you mean '{}'?", nearest_word(shape, names)));
}

}  // namespace matchlight
