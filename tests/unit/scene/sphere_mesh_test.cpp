// Spheres as triangles: as round as they are said to be, closed, and no more than are allowed.
#include "scene/sphere_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

SphereSet two_spheres() {
    SphereSet set;
    set.spheres = {{{1, 2, 3}, 0.5F}, {{-4, 0, 0}, 2}};
    set.colors = {{255, 0, 0, 255}, {0, 0, 255, 255}};
    set.update_bounds();
    return set;
}

TEST(SphereMesh, IsAsRoundAsItSays) {
    const SphereSet set = two_spheres();
    for (const auto& [halvings, deviation] : {std::pair(2, 0.03), std::pair(5, 0.0005)}) {
        const ModelMesh mesh = mesh_of_spheres(set, halvings).meshes.at(0);
        ASSERT_EQ(mesh.indices.size() / 3, 2 * sphere_triangles(halvings));
        double farthest_out = 0, farthest_in = 0, volume = 0;
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            const Sphere& sphere = set.spheres[i / 3 / sphere_triangles(halvings)];
            const Eigen::Vector3d centre = Eigen::Vector3f(sphere.centre_m.data()).cast<double>();
            Eigen::Matrix3d corners;
            for (int k = 0; k < 3; ++k) {
                const ModelVertex& vertex = mesh.vertices[mesh.indices[i + static_cast<std::size_t>(k)]];
                corners.col(k) = (Eigen::Vector3f(vertex.position.data()).cast<double>() - centre) / sphere.radius_m;
                farthest_out = std::max(farthest_out, corners.col(k).norm() - 1);
                EXPECT_GT(Eigen::Vector3f(vertex.normal.data()).cast<double>().dot(corners.col(k)), 0.99);
            }
            farthest_in = std::max(farthest_in, 1 - corners.rowwise().mean().norm());
            volume += corners.determinant() / 6;
        }
        EXPECT_LT(farthest_out, deviation);
        EXPECT_LT(farthest_in, deviation);
        EXPECT_GT(farthest_out, deviation / 2) << "and is no finer than it says";
        EXPECT_NEAR(volume / (8 * std::atan(1) * 4 / 3), 1, 2 * deviation) << "faces look outwards";
    }
}

TEST(SphereMesh, KeepsColoursAndBox) {
    const Model model = mesh_of_spheres(two_spheres(), 5);
    EXPECT_EQ(model.meshes[0].vertices.front().color, (std::array<float, 4>{1, 0, 0, 1}));
    EXPECT_EQ(model.meshes[0].vertices.back().color, (std::array<float, 4>{0, 0, 1, 1}));
    EXPECT_TRUE(model.bounds_m.min().isApprox(Eigen::Vector3d(-6, -2, -2), 1e-3));
    EXPECT_TRUE(model.bounds_m.max().isApprox(Eigen::Vector3d(1.5, 2.5, 3.5), 1e-3));
    EXPECT_TRUE(mesh_of_spheres({}, 2).meshes.at(0).indices.empty());
}

TEST(SphereMesh, HasFewerTrianglesTheMoreThereAre) {
    EXPECT_EQ(sphere_halvings(1), 5);
    EXPECT_EQ(sphere_halvings(1000), 3);
    EXPECT_EQ(sphere_halvings(7812), 2);
    EXPECT_FALSE(sphere_halvings(7813));
}

}  // namespace
}  // namespace matchlight
