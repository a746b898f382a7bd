// Splits triangles by their centroids until few are left.
#include "scene/triangle_tree.h"

#include <cassert>

#include <Eigen/Geometry>

#include "scene/box_split.h"

namespace matchlight {

namespace {

struct Candidate {
    TreeTriangle triangle;
    Eigen::AlignedBox3f box;
    Eigen::Vector3f centroid;
};

class Builder {
public:
    explicit Builder(std::vector<Candidate> candidates) : candidates_(std::move(candidates)) {}

    TriangleTree build() {
        if (!candidates_.empty()) add_node(candidates_);
        return std::move(tree_);
    }

private:
    void add_node(std::span<Candidate> part) {
        const std::size_t index = tree_.nodes.size();
        tree_.nodes.emplace_back();
        Eigen::AlignedBox3f box;
        for (const Candidate& candidate : part) box.extend(candidate.box);
        TriangleTreeNode node;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            node.low.at(axis) = box.min()[static_cast<int>(axis)];
            node.high.at(axis) = box.max()[static_cast<int>(axis)];
        }
        if (part.size() <= TriangleTreeNode::most_triangles) {
            constexpr std::uint32_t count_values = 8;
            node.leaf = static_cast<std::uint32_t>(tree_.triangles.size()) * count_values +
                        static_cast<std::uint32_t>(part.size());
            for (const Candidate& candidate : part) tree_.triangles.push_back(candidate.triangle);
        } else {
            const std::size_t left = split_by_area(
                part, [](const Candidate& one) { return one.box; }, [](const Candidate& one) { return one.centroid; });
            add_node(part.first(left));
            add_node(part.subspan(left));
        }
        node.skip = static_cast<std::int32_t>(tree_.nodes.size());
        tree_.nodes[index] = node;
    }

    std::vector<Candidate> candidates_;
    TriangleTree tree_;
};

}  // namespace

TriangleTree make_triangle_tree(std::span<const ModelVertex> vertices, std::span<const std::uint32_t> indices) {
    std::vector<Candidate> candidates;
    candidates.reserve(indices.size() / 3);
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        Candidate& candidate = candidates.emplace_back();
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t index = indices[i + corner];
            assert(index < vertices.size());
            candidate.triangle.corners.at(corner) = index;
            candidate.box.extend(Eigen::Vector3f(vertices[index].position.data()));
        }
        candidate.centroid = candidate.box.center();
    }
    return Builder(std::move(candidates)).build();
}

TriangleTree make_sphere_tree(std::span<const Sphere> spheres) {
    std::vector<Candidate> candidates;
    candidates.reserve(spheres.size());
    for (const Sphere& sphere : spheres) {
        Candidate& candidate = candidates.emplace_back();
        candidate.triangle.corners[0] = static_cast<std::uint32_t>(&sphere - spheres.data());
        candidate.centroid = Eigen::Vector3f(sphere.centre_m.data());
        const Eigen::Vector3f reach = Eigen::Vector3f::Constant(sphere.radius_m);
        candidate.box = {candidate.centroid - reach, candidate.centroid + reach};
    }
    return Builder(std::move(candidates)).build();
}

void refit(TriangleTree& tree, std::span<const ModelVertex> vertices) {
    constexpr std::uint32_t count_values = 8;
    // Children come after their parent.
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {
        TriangleTreeNode& node = tree.nodes[i];
        Eigen::AlignedBox3f box;
        if (node.leaf != 0) {
            for (std::uint32_t t = 0; t < node.leaf % count_values; ++t) {
                for (const std::uint32_t corner : tree.triangles[node.leaf / count_values + t].corners)
                    box.extend(Eigen::Vector3f(vertices[corner].position.data()));
            }
        } else {
            for (std::size_t child = i + 1; child < static_cast<std::size_t>(node.skip);
                 child = static_cast<std::size_t>(tree.nodes[child].skip)) {
                box.extend(Eigen::Vector3f(tree.nodes[child].low.data()));
                box.extend(Eigen::Vector3f(tree.nodes[child].high.data()));
            }
        }
        for (int axis = 0; axis < 3; ++axis) {
            node.low.at(static_cast<std::size_t>(axis)) = box.min()[axis];
            node.high.at(static_cast<std::size_t>(axis)) = box.max()[axis];
        }
    }
}

}  // namespace matchlight
