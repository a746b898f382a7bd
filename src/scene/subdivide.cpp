// Rounds of halving: in each, a triangle with one, two or three long edges becomes two, three or four.
#include "scene/subdivide.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "scene/mesh_geometry.h"

namespace matchlight {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

class Splitter {
public:
    Splitter(ModelMesh& mesh, double longest_edge_m) : mesh_(mesh), longest_m_(longest_edge_m) {}

    bool is_long(std::uint32_t a, std::uint32_t b) const {
        const auto& p = mesh_.vertices[a].position;
        const auto& q = mesh_.vertices[b].position;
        return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]) > longest_m_;
    }

    std::uint32_t middle_of(std::uint32_t a, std::uint32_t b) {
        const auto [known, is_new] = middles_.try_emplace(std::minmax(a, b), 0U);
        if (is_new) {
            known->second = static_cast<std::uint32_t>(mesh_.vertices.size());
            mesh_.vertices.push_back(middle_of_edge(mesh_.vertices[a], mesh_.vertices[b]));
            if (mesh_.binding) mesh_.derived.push_back({a, b});
        }
        return known->second;
    }

    /// Appends what becomes of one triangle.
    void split(Triangle t, std::vector<std::uint32_t>& out) {
        // Turned so that long edges come first: 0–1, then 1–2, then 2–0.
        const auto count = [&](const Triangle& x) {
            return int{is_long(x[0], x[1])} + int{is_long(x[1], x[2])} + int{is_long(x[2], x[0])};
        };
        const int long_edges = count(t);
        while (long_edges > 0 && long_edges < 3 && !(is_long(t[0], t[1]) && (long_edges == 1 || is_long(t[1], t[2])))) {
            std::rotate(t.begin(), t.begin() + 1, t.end());
        }
        const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) { out.insert(out.end(), {a, b, c}); };
        if (long_edges == 0) return add(t[0], t[1], t[2]);
        const std::uint32_t m01 = middle_of(t[0], t[1]);
        if (long_edges == 1) {
            add(t[0], m01, t[2]);
            add(m01, t[1], t[2]);
            return;
        }
        const std::uint32_t m12 = middle_of(t[1], t[2]);
        add(m01, t[1], m12);
        if (long_edges == 2) {
            add(t[0], m01, m12);
            add(t[0], m12, t[2]);
            return;
        }
        const std::uint32_t m20 = middle_of(t[2], t[0]);
        add(t[0], m01, m20);
        add(m20, m12, t[2]);
        add(m01, m12, m20);
    }

private:
    ModelMesh& mesh_;
    double longest_m_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles_;
};

}  // namespace

ModelMesh with_short_edges(const ModelMesh& mesh, double longest_edge_m, std::size_t most_vertices) {
    ModelMesh result = mesh;
    // Each round halves the longest edge; 16 rounds halve it 65,536 times.
    constexpr int most_rounds = 16;
    for (int round = 0; round < most_rounds; ++round) {
        ModelMesh next = result;
        next.indices.clear();
        Splitter splitter(next, longest_edge_m);
        for (std::size_t i = 0; i + 2 < result.indices.size(); i += 3) {
            splitter.split({result.indices[i], result.indices[i + 1], result.indices[i + 2]}, next.indices);
            if (next.vertices.size() > most_vertices) return result;
        }
        const bool done = next.indices.size() == result.indices.size();
        result = std::move(next);
        if (done) break;
    }
    return result;
}

}  // namespace matchlight
