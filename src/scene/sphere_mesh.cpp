// One octahedron is divided, and placed for every sphere.
#include "scene/sphere_mesh.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "core/transfer.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;

struct RoundSolid {
    std::vector<Vector3d> corners;  // of length 1
    std::vector<std::array<std::uint32_t, 3>> faces;
};

RoundSolid octahedron() {
    RoundSolid solid;
    for (const Vector3d& axis : {Vector3d(Vector3d::UnitX()), Vector3d(Vector3d::UnitY()), Vector3d(Vector3d::UnitZ())})
        solid.corners.insert(solid.corners.end(), {axis, Vector3d(-axis)});
    // Counter-clockwise seen from outside: x, y, z, and each mirroring turns that round.
    for (const std::uint32_t x : {0U, 1U}) {
        for (const std::uint32_t y : {2U, 3U}) {
            for (const std::uint32_t z : {4U, 5U}) {
                const bool turned = (x + y + z) % 2 == 1;
                solid.faces.push_back(turned ? std::array{x, z, y} : std::array{x, y, z});
            }
        }
    }
    return solid;
}

RoundSolid halved(const RoundSolid& coarse) {
    RoundSolid fine{coarse.corners, {}};
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
        const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), fine.corners.size());
        if (is_new) fine.corners.push_back((fine.corners[a] + fine.corners[b]).normalized());
        return place->second;
    };
    for (const auto& [a, b, c] : coarse.faces) {
        const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        fine.faces.insert(fine.faces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    return fine;
}

/// How far its corners are to lie from the middle for a sphere of radius 1 to lie halfway between them and its faces.
double balanced_radius(const RoundSolid& solid) {
    double nearest = 1;
    for (const auto& [a, b, c] : solid.faces) {
        const Vector3d& corner = solid.corners[a];
        const Vector3d normal = (solid.corners[b] - corner).cross(solid.corners[c] - corner).normalized();
        nearest = std::min(nearest, normal.dot(corner));
    }
    return 2 / (1 + nearest);
}

std::array<float, 4> own_color(const SphereSet& set, std::size_t sphere) {
    if (set.colors.empty()) return {1, 1, 1, 1};
    std::array<float, 4> color{0, 0, 0, 1};
    for (std::size_t c = 0; c < 3; ++c) {
        color.at(c) = static_cast<float>(linear_from_srgb_code(set.colors[sphere].at(c) / 255.0));
    }
    return color;
}

}  // namespace

std::optional<int> sphere_halvings(std::size_t spheres) {
    for (int halvings = most_sphere_halvings; halvings >= fewest_sphere_halvings; --halvings) {
        if (spheres <= most_sphere_triangles / sphere_triangles(halvings)) return halvings;
    }
    return std::nullopt;
}

Model mesh_of_spheres(const SphereSet& set, int halvings) {
    RoundSolid solid = octahedron();
    for (int i = 0; i < halvings; ++i) solid = halved(solid);
    const double radius = balanced_radius(solid);
    Model model;
    model.name = set.name;
    ModelMaterial& material = model.materials.emplace_back();
    if (set.colors.empty()) material.base_color = {set.color[0], set.color[1], set.color[2], 1};
    ModelMesh& mesh = model.meshes.emplace_back();
    mesh.vertices.reserve(set.size() * solid.corners.size());
    mesh.indices.reserve(set.size() * solid.faces.size() * 3);
    for (std::size_t i = 0; i < set.size(); ++i) {
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        const Sphere& sphere = set.spheres[i];
        const Vector3d centre_m = Eigen::Vector3f(sphere.centre_m.data()).cast<double>();
        for (const Vector3d& normal : solid.corners) {
            ModelVertex vertex{};
            Eigen::Vector3f::Map(vertex.position.data()) = (centre_m + sphere.radius_m * radius * normal).cast<float>();
            Eigen::Vector3f::Map(vertex.normal.data()) = normal.cast<float>();
            vertex.color = own_color(set, i);
            mesh.vertices.push_back(vertex);
        }
        for (const std::array<std::uint32_t, 3>& face : solid.faces) {
            for (const std::uint32_t corner : face) mesh.indices.push_back(first + corner);
        }
    }
    model.update_bounds();
    return model;
}

}  // namespace matchlight
