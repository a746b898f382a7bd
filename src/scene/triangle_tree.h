// A hierarchy of boxes over a mesh's triangles, laid out for the GPU to walk without a stack.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/model.h"
#include "scene/sphere_set.h"

namespace matchlight {

/// Nodes lie in depth-first order: after a node comes its first child, and `skip` is the node after all of its own.
/// A ray that misses a box goes on at `skip` (Smits 1998, "Efficiency Issues for Ray Tracing").
struct TriangleTreeNode {
    std::array<float, 3> low{};
    std::int32_t skip = 0;
    std::array<float, 3> high{};
    std::uint32_t leaf = 0;  // first triangle · 8 + number of triangles; 0: an inner node

    static constexpr std::uint32_t most_triangles = 4;
};

/// A triangle in the tree's order, its corners by their numbers in the mesh.
struct TreeTriangle {
    std::array<std::uint32_t, 3> corners{};
};

struct TriangleTree {
    std::vector<TriangleTreeNode> nodes;
    std::vector<TreeTriangle> triangles;
};

/// Split by the surface area heuristic over 16 bins of centroids (Wald 2007, "On fast Construction of SAH-based
/// Bounding Volume Hierarchies"). Deterministic. Indices are those of triangles, all in range; fewer than 2^29
/// triangles.
TriangleTree make_triangle_tree(std::span<const ModelVertex> vertices, std::span<const std::uint32_t> indices);

/// The same over spheres, each a triangle whose first corner is the sphere's number.
TriangleTree make_sphere_tree(std::span<const Sphere> spheres);

/// Gives the boxes the vertices' places, which were other ones when the tree was made; which triangles lie together
/// stays as it was.
void refit(TriangleTree& tree, std::span<const ModelVertex> vertices);

}  // namespace matchlight
