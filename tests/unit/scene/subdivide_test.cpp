// Subdivision keeps shape and area, and meshes that touch go on touching.
#include "scene/subdivide.h"

#include <cmath>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

double area(const ModelMesh& mesh) {
    double sum = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const auto at = [&](std::size_t k) {
            const auto& p = mesh.vertices[mesh.indices[i + k]].position;
            return Eigen::Vector3d(p[0], p[1], p[2]);
        };
        sum += (at(1) - at(0)).cross(at(2) - at(0)).norm() / 2;
    }
    return sum;
}

double longest_edge(const ModelMesh& mesh) {
    double longest = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        const std::size_t j = i % 3 == 2 ? i - 2 : i + 1;
        const auto& p = mesh.vertices[mesh.indices[i]].position;
        const auto& q = mesh.vertices[mesh.indices[j]].position;
        longest = std::max<double>(longest, std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
    }
    return longest;
}

TEST(Subdivide, ShortensEveryEdgeAndKeepsTheArea) {
    const Model box = make_shape("box", "scene.toml");
    for (const ModelMesh& mesh : box.meshes) {
        const ModelMesh fine = with_short_edges(mesh, 0.1, 100000);
        EXPECT_LE(longest_edge(fine), 0.1);
        EXPECT_NEAR(area(fine), area(mesh), 1e-5);
        EXPECT_GT(fine.vertices.size(), mesh.vertices.size());
    }
}

TEST(Subdivide, LeavesAFineMeshAsItIs) {
    const Model sphere = make_shape("sphere", "scene.toml");
    const ModelMesh same = with_short_edges(sphere.meshes[0], 10, 100000);
    EXPECT_EQ(same.indices, sphere.meshes[0].indices);
}

TEST(Subdivide, StopsBeforeTooManyVertices) {
    const Model plane = make_shape("plane", "scene.toml");
    EXPECT_LE(with_short_edges(plane.meshes[0], 1e-6, 5000).vertices.size(), 5000u);
}

}  // namespace
}  // namespace matchlight
