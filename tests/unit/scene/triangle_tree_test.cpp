// The boxes hold their triangles, every triangle is in one leaf, and a walk over the boxes finds what all triangles
// together have nearest.
#include "scene/triangle_tree.h"

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

TriangleTree tree_of(const ModelMesh& mesh) {
    return make_triangle_tree(mesh.vertices, mesh.indices);
}

Eigen::Vector3f corner_of(const ModelMesh& mesh, const TreeTriangle& triangle, std::size_t i) {
    return Eigen::Vector3f(mesh.vertices[triangle.corners.at(i)].position.data());
}

void check_boxes(const ModelMesh& mesh, const TriangleTree& tree) {
    std::vector<int> seen(tree.triangles.size(), 0);
    for (std::size_t node = 0; node < tree.nodes.size(); ++node) {
        const TriangleTreeNode& box = tree.nodes[node];
        ASSERT_GT(box.skip, static_cast<int>(node));
        ASSERT_LE(box.skip, static_cast<int>(tree.nodes.size()));
        // All leaves under the node.
        for (std::size_t inner = node; inner < static_cast<std::size_t>(box.skip); ++inner) {
            const std::uint32_t leaf = tree.nodes[inner].leaf;
            for (std::uint32_t i = leaf / 8; i < leaf / 8 + leaf % 8; ++i) {
                if (inner == node) ++seen[i];
                for (std::size_t corner = 0; corner < 3; ++corner) {
                    for (std::size_t axis = 0; axis < 3; ++axis) {
                        const float at = corner_of(mesh, tree.triangles[i], corner)[static_cast<int>(axis)];
                        ASSERT_GE(at, box.low.at(axis));
                        ASSERT_LE(at, box.high.at(axis));
                    }
                }
            }
        }
    }
    for (const int times : seen) EXPECT_EQ(times, 1);
}

TEST(TriangleTree, BoxesHoldWhatIsUnderThem) {
    for (const char* shape : {"sphere", "torus", "teapot", "box"}) {
        const Model model = make_shape(shape, "scene.toml");
        for (const ModelMesh& mesh : model.meshes) {
            const TriangleTree tree = tree_of(mesh);
            EXPECT_EQ(tree.triangles.size(), mesh.indices.size() / 3);
            check_boxes(mesh, tree);
        }
    }
}

TEST(TriangleTree, KeepsEveryTriangleOnce) {
    const Model model = make_shape("torus", "scene.toml");
    const ModelMesh& mesh = model.meshes.front();
    std::multiset<std::array<std::uint32_t, 3>> before, after;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
        before.insert({mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]});
    for (const TreeTriangle& triangle : tree_of(mesh).triangles) after.insert(triangle.corners);
    EXPECT_EQ(before, after);
}

TEST(TriangleTree, TakesTrianglesThatLieInOnePlace) {
    ModelMesh mesh;
    mesh.vertices.resize(3);
    mesh.vertices[1].position = {1, 0, 0};
    mesh.vertices[2].position = {0, 1, 0};
    for (int i = 0; i < 100; ++i) mesh.indices.insert(mesh.indices.end(), {0, 1, 2});
    const TriangleTree tree = tree_of(mesh);
    EXPECT_EQ(tree.triangles.size(), 100U);
    check_boxes(mesh, tree);
}

TEST(TriangleTree, OfNothingIsNothing) {
    const TriangleTree tree = make_triangle_tree({}, {});
    EXPECT_TRUE(tree.nodes.empty());
    EXPECT_TRUE(tree.triangles.empty());
}

}  // namespace
}  // namespace matchlight
