// Cuts triangles evenly, moves their corners, finds the normals anew.
#include "report/relief_reference.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>

#include "scene/mesh_geometry.h"
#include "scene/relief_map.h"

namespace matchlight {

namespace {

/// One of a vertex's arrays, between three corners.
template <class Values>
Values mixed(const std::array<ModelVertex, 3>& corners, Values ModelVertex::*member, const Eigen::Vector3d& weights) {
    Values result{};
    for (std::size_t c = 0; c < result.size(); ++c) {
        double sum = 0;
        for (std::size_t i = 0; i < 3; ++i) sum += weights[static_cast<Eigen::Index>(i)] * (corners[i].*member)[c];
        result[c] = static_cast<float>(sum);
    }
    return result;
}

ModelVertex carved_vertex(const std::array<ModelVertex, 3>& corners, const Eigen::Vector3d& weights,
                          const CarvedHeights& carved) {
    const auto of = [&](auto member) { return mixed(corners, member, weights); };
    ModelVertex vertex{of(&ModelVertex::position), of(&ModelVertex::normal), of(&ModelVertex::tangent),
                       of(&ModelVertex::uv),       of(&ModelVertex::color),  of(&ModelVertex::uv_second)};
    const Eigen::Vector3d normal = Eigen::Vector3f(vertex.normal.data()).cast<double>().normalized();
    const double down = carved.depth * (1 - height_at(carved.heights, carved.wrap, vertex.uv[0], vertex.uv[1]));
    for (std::size_t c = 0; c < 3; ++c)
        vertex.position[c] = static_cast<float>(vertex.position[c] - down * normal[static_cast<Eigen::Index>(c)]);
    return vertex;
}

/// Texels along the longest side of a triangle.
int cuts_of(const std::array<ModelVertex, 3>& corners, const ImageF& heights) {
    double longest = 1;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto &a = corners[i].uv, &b = corners[(i + 1) % 3].uv;
        longest = std::max({longest, std::abs(static_cast<double>(a[0]) - b[0]) * heights.width(),
                            std::abs(static_cast<double>(a[1]) - b[1]) * heights.height()});
    }
    constexpr double most = 4096;
    return static_cast<int>(std::ceil(std::min(longest, most)));
}

}  // namespace

Model displaced_model(const Model& model, const CarvedHeights& carved) {
    constexpr std::size_t most_vertices = 16'000'000;
    Model result = model;
    for (std::size_t number = 0; number < model.meshes.size(); ++number) {
        const ModelMesh& from = model.meshes[number];
        ModelMesh& mesh = result.meshes[number];
        mesh.vertices.clear();
        mesh.indices.clear();
        for (std::size_t t = 0; t + 2 < from.indices.size(); t += 3) {
            const std::array<ModelVertex, 3> corners{from.vertices[from.indices[t]], from.vertices[from.indices[t + 1]],
                                                     from.vertices[from.indices[t + 2]]};
            const int cuts = cuts_of(corners, carved.heights);
            if (mesh.vertices.size() + static_cast<std::size_t>(cuts) * cuts > most_vertices)
                throw std::length_error("the map is too fine for a displaced surface");
            // Rows from the first corner to the side across from it, each of one corner more.
            const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
            for (int row = 0; row <= cuts; ++row) {
                for (int i = 0; i <= row; ++i) {
                    const double down = static_cast<double>(row) / cuts, across = static_cast<double>(i) / cuts;
                    mesh.vertices.push_back(carved_vertex(corners, {1 - down, down - across, across}, carved));
                }
            }
            const auto corner = [&](int row, int i) {
                return first + static_cast<std::uint32_t>(row * (row + 1) / 2 + i);
            };
            for (int row = 0; row < cuts; ++row) {
                for (int i = 0; i <= row; ++i) {
                    mesh.indices.insert(mesh.indices.end(),
                                        {corner(row, i), corner(row + 1, i), corner(row + 1, i + 1)});
                    if (i < row)
                        mesh.indices.insert(mesh.indices.end(),
                                            {corner(row, i), corner(row + 1, i + 1), corner(row, i + 1)});
                }
            }
        }
        constexpr double no_creases_deg = 180;
        compute_normals(mesh, no_creases_deg);
    }
    result.update_bounds();
    return result;
}

}  // namespace matchlight
