// Finds out whether a mesh is the closed, outward-wound boundary of something solid.
#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "render/surface_mesh.h"

namespace matchlight {

namespace {

/// For each vertex the first one at the same position.
std::vector<std::uint32_t> welded(const std::vector<ModelVertex>& vertices) {
    std::vector<std::uint32_t> order(vertices.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
        return std::pair(vertices[a].position, a) < std::pair(vertices[b].position, b);
    });
    std::vector<std::uint32_t> first(vertices.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && vertices[order[i]].position == vertices[order[i - 1]].position;
        first[order[i]] = same ? first[order[i - 1]] : order[i];
    }
    return first;
}

/// The connected parts of a mesh, by union and find with path halving.
class Parts {
public:
    explicit Parts(std::size_t vertices) : parent_(vertices) { std::iota(parent_.begin(), parent_.end(), 0U); }
    std::uint32_t of(std::uint32_t vertex) {
        while (parent_[vertex] != vertex) vertex = parent_[vertex] = parent_[parent_[vertex]];
        return vertex;
    }
    void join(std::uint32_t a, std::uint32_t b) { parent_[of(a)] = of(b); }

private:
    std::vector<std::uint32_t> parent_;
};

Eigen::Vector3d position_of(const ModelVertex& vertex) {
    return {vertex.position[0], vertex.position[1], vertex.position[2]};
}

}  // namespace

bool is_closed_outward_surface(const ModelMesh& mesh) {
    if (mesh.indices.empty()) return false;
    const std::vector<std::uint32_t> corner = welded(mesh.vertices);
    Parts parts(mesh.vertices.size());
    // Each edge of a closed surface is walked as often one way as the other.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> forward;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> backward;
    std::map<std::uint32_t, double> volumes;  // six times, signed, by part
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const std::uint32_t a = corner[mesh.indices[i]];
        const std::uint32_t b = corner[mesh.indices[i + 1]];
        const std::uint32_t c = corner[mesh.indices[i + 2]];
        if (a == b || b == c || c == a) continue;  // no area: covers nothing
        for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
            forward.emplace_back(from, to);
            backward.emplace_back(to, from);
            parts.join(from, to);
        }
    }
    std::ranges::sort(forward);
    std::ranges::sort(backward);
    if (forward.empty() || forward != backward) return false;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const std::uint32_t a = corner[mesh.indices[i]];
        const Eigen::Vector3d origin =
            position_of(mesh.vertices[parts.of(a)]);  // near, so that large terms do not cancel
        const Eigen::Vector3d p = position_of(mesh.vertices[a]) - origin;
        const Eigen::Vector3d q = position_of(mesh.vertices[corner[mesh.indices[i + 1]]]) - origin;
        const Eigen::Vector3d r = position_of(mesh.vertices[corner[mesh.indices[i + 2]]]) - origin;
        volumes[parts.of(a)] += p.dot(q.cross(r));
    }
    return std::ranges::all_of(volumes, [](const auto& part) { return part.second > 0; });
}

}  // namespace matchlight
