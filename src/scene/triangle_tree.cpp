// Splits triangles by their centroids until few are left.
#include "scene/triangle_tree.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace matchlight {

namespace {

struct Candidate {
    TreeTriangle triangle;
    Eigen::AlignedBox3f box;
    Eigen::Vector3f centroid;
};

float half_area(const Eigen::AlignedBox3f& box) {
    if (box.isEmpty()) return 0;
    const Eigen::Vector3f size = box.sizes();
    return size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
}

class Builder {
public:
    explicit Builder(std::vector<Candidate> candidates) : candidates_(std::move(candidates)) {}

    TriangleTree build() {
        if (!candidates_.empty()) add_node(candidates_);
        return std::move(tree_);
    }

private:
    static constexpr int bins = 16;

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
            const std::size_t left = split(part);
            add_node(part.first(left));
            add_node(part.subspan(left));
        }
        node.skip = static_cast<std::int32_t>(tree_.nodes.size());
        tree_.nodes[index] = node;
    }

    /// Orders the part; how many go to its first half.
    static std::size_t split(std::span<Candidate> part) {
        Eigen::AlignedBox3f centroids;
        for (const Candidate& candidate : part) centroids.extend(candidate.centroid);
        int axis = 0;
        const float extent = centroids.sizes().maxCoeff(&axis);
        const float low = centroids.min()[axis];
        // Triangles that all lie in one place cannot be told apart.
        if (!(extent > 0)) return part.size() / 2;
        const auto bin_of = [&](const Candidate& candidate) {
            const float share = (candidate.centroid[axis] - low) / extent;
            return std::clamp(static_cast<int>(share * bins), 0, bins - 1);
        };
        std::array<Eigen::AlignedBox3f, bins> boxes;
        std::array<std::size_t, bins> counts{};
        for (const Candidate& candidate : part) {
            const auto bin = static_cast<std::size_t>(bin_of(candidate));
            boxes.at(bin).extend(candidate.box);
            ++counts.at(bin);
        }
        std::array<float, bins> cost_above{};  // of all bins from this one on
        Eigen::AlignedBox3f box;
        std::size_t count = 0;
        for (std::size_t bin = bins; bin-- > 1;) {
            box.extend(boxes.at(bin));
            count += counts.at(bin);
            cost_above.at(bin) = half_area(box) * static_cast<float>(count);
        }
        box.setEmpty();
        count = 0;
        float least = std::numeric_limits<float>::infinity();
        int first_above = bins / 2;
        for (std::size_t bin = 1; bin < bins; ++bin) {
            box.extend(boxes.at(bin - 1));
            count += counts.at(bin - 1);
            if (count == 0 || count == part.size()) continue;
            const float cost = half_area(box) * static_cast<float>(count) + cost_above.at(bin);
            if (cost < least) {
                least = cost;
                first_above = static_cast<int>(bin);
            }
        }
        const auto middle = std::stable_partition(
            part.begin(), part.end(), [&](const Candidate& candidate) { return bin_of(candidate) < first_above; });
        const auto left = static_cast<std::size_t>(middle - part.begin());
        return left == 0 || left == part.size() ? part.size() / 2 : left;
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

}  // namespace matchlight
