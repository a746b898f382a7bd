// Normals, tangents and clean-up of triangle meshes.
#include "scene/mesh_geometry.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string_view>
#include <unordered_map>

namespace matchlight {
namespace {

using Eigen::Vector3d;

Vector3d vector_of(const std::array<float, 3>& a) {
    return {a[0], a[1], a[2]};
}

std::array<float, 3> narrowed(const Vector3d& v) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

std::size_t triangle_count(const ModelMesh& mesh) {
    return mesh.indices.size() / 3;
}

Vector3d position(const ModelMesh& mesh, std::size_t corner) {
    return vector_of(mesh.vertices[mesh.indices[corner]].position);
}

/// Twice the area times the unit normal, counter-clockwise seen from its tip.
Vector3d area_normal(const ModelMesh& mesh, std::size_t triangle) {
    const Vector3d a = position(mesh, 3 * triangle);
    return (position(mesh, 3 * triangle + 1) - a).cross(position(mesh, 3 * triangle + 2) - a);
}

/// The triangle's angle at a corner, radians.
double corner_angle(const ModelMesh& mesh, std::size_t corner) {
    const std::size_t first = corner - corner % 3;
    const Vector3d here = position(mesh, corner);
    const Vector3d one = position(mesh, first + (corner + 1) % 3) - here;
    const Vector3d other = position(mesh, first + (corner + 2) % 3) - here;
    return std::atan2(one.cross(other).norm(), one.dot(other));
}

/// Corners at equal positions have equal numbers, from 0 without gaps.
std::vector<std::uint32_t> position_numbers(const ModelMesh& mesh, std::uint32_t& count) {
    struct Hash {
        std::size_t operator()(const std::array<float, 3>& p) const {
            std::size_t hash = 0;
            for (const float c : p) hash = (hash ^ std::bit_cast<std::uint32_t>(c + 0.0f)) * 0x9e3779b97f4a7c15u;
            return hash ^ (hash >> 32);  // −0 + 0 = 0: both zeros are one position
        }
    };
    std::unordered_map<std::array<float, 3>, std::uint32_t, Hash> numbers;
    std::vector<std::uint32_t> of_corner(mesh.indices.size());
    for (std::size_t corner = 0; corner < of_corner.size(); ++corner) {
        const auto& p = mesh.vertices[mesh.indices[corner]].position;
        of_corner[corner] = numbers.try_emplace(p, static_cast<std::uint32_t>(numbers.size())).first->second;
    }
    count = static_cast<std::uint32_t>(numbers.size());
    return of_corner;
}

template <std::size_t N>
std::array<float, N> middle(const std::array<float, N>& a, const std::array<float, N>& b) {
    std::array<float, N> result;
    for (std::size_t i = 0; i < N; ++i) result[i] = 0.5F * (a[i] + b[i]);
    return result;
}

template <std::size_t N>
void normalize_first_three(std::array<float, N>& v) {
    const float length = std::hypot(v[0], v[1], v[2]);
    if (length > 0) {
        for (std::size_t i = 0; i < 3; ++i) v[i] /= length;
    }
}

}  // namespace

std::size_t drop_bad_triangles(ModelMesh& mesh) {
    // Positions are floats, so products of their differences are exact to about 1e-15 in double; collinear corners stay
    // far below this, the thinnest triangle with an area that floats can express far above.
    constexpr double smallest_relative_area = 1e-13;
    std::vector<std::uint32_t> kept;
    kept.reserve(mesh.indices.size());
    for (std::size_t triangle = 0; triangle < triangle_count(mesh); ++triangle) {
        const Vector3d a = position(mesh, 3 * triangle);
        const Vector3d b = position(mesh, 3 * triangle + 1);
        const Vector3d c = position(mesh, 3 * triangle + 2);
        if (!a.allFinite() || !b.allFinite() || !c.allFinite()) continue;
        const double longest2 = std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()});
        if (area_normal(mesh, triangle).norm() <= smallest_relative_area * longest2) continue;
        kept.insert(kept.end(), mesh.indices.begin() + static_cast<std::ptrdiff_t>(3 * triangle),
                    mesh.indices.begin() + static_cast<std::ptrdiff_t>(3 * triangle + 3));
    }
    const std::size_t dropped = (mesh.indices.size() - kept.size()) / 3;
    mesh.indices = std::move(kept);
    return dropped;
}

void compute_normals(ModelMesh& mesh, double crease_deg) {
    // Around a point where more triangles meet than this the sum over pairs would take too long; no modelled crease
    // does, and such a fan keeps the normals of its triangles.
    constexpr std::size_t most_neighbours = 2048;
    const double cos_crease = std::cos(crease_deg * std::numbers::pi / 180) - 1e-9;

    std::vector<Vector3d> face_normals(triangle_count(mesh));
    for (std::size_t t = 0; t < face_normals.size(); ++t) face_normals[t] = area_normal(mesh, t).normalized();

    // Corners sorted by position: those of position p are sorted[starts[p] … starts[p + 1]).
    std::uint32_t position_count = 0;
    const std::vector<std::uint32_t> numbers = position_numbers(mesh, position_count);
    std::vector<std::size_t> starts(position_count + 1);
    for (const std::uint32_t number : numbers) ++starts[number + 1];
    for (std::size_t p = 1; p < starts.size(); ++p) starts[p] += starts[p - 1];
    std::vector<std::size_t> sorted(numbers.size());
    std::vector<std::size_t> next(starts.begin(), starts.end() - 1);
    for (std::size_t corner = 0; corner < numbers.size(); ++corner) sorted[next[numbers[corner]]++] = corner;

    std::vector<double> angles(numbers.size());
    for (std::size_t corner = 0; corner < angles.size(); ++corner) angles[corner] = corner_angle(mesh, corner);

    std::vector<ModelVertex> vertices(numbers.size());
    for (std::size_t corner = 0; corner < numbers.size(); ++corner) {
        const Vector3d& own = face_normals[corner / 3];
        const std::size_t first = starts[numbers[corner]];
        const std::size_t last = starts[numbers[corner] + 1];
        Vector3d sum = Vector3d::Zero();
        if (last - first <= most_neighbours) {
            for (std::size_t i = first; i < last; ++i) {
                const Vector3d& other = face_normals[sorted[i] / 3];
                if (own.dot(other) >= cos_crease) sum += angles[sorted[i]] * other;
            }
        }
        vertices[corner] = mesh.vertices[mesh.indices[corner]];
        vertices[corner].normal = narrowed(sum.norm() > 0 ? sum.normalized() : own);
    }
    mesh.vertices = std::move(vertices);
    for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
        mesh.indices[corner] = static_cast<std::uint32_t>(corner);
    }
    weld(mesh);
}

std::size_t repair_normals(ModelMesh& mesh) {
    std::vector<char> bad(mesh.vertices.size(), 0);
    std::size_t count = 0;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const Vector3d normal = vector_of(mesh.vertices[v].normal);
        // Unit length is what a file should hold; a length that floats cannot normalise says nothing of a direction.
        if (normal.allFinite() && normal.norm() > 1e-6) {
            mesh.vertices[v].normal = narrowed(normal.normalized());
        } else {
            bad[v] = 1;
            ++count;
        }
    }
    if (count == 0) return 0;
    std::vector<Vector3d> sums(mesh.vertices.size(), Vector3d::Zero());
    for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
        const std::uint32_t v = mesh.indices[corner];
        if (bad[v]) sums[v] += corner_angle(mesh, corner) * area_normal(mesh, corner / 3).normalized();
    }
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        if (bad[v]) mesh.vertices[v].normal = narrowed(sums[v].norm() > 0 ? sums[v].normalized() : Vector3d::UnitZ());
    }
    return count;
}

void compute_tangents(ModelMesh& mesh, const UvMapping& mapping) {
    // sums[0]: texture as it is; sums[1]: mirrored.
    std::array<std::vector<Vector3d>, 2> sums;
    for (auto& sum : sums) sum.assign(mesh.vertices.size(), Vector3d::Zero());
    std::vector<signed char> mirrored(triangle_count(mesh), -1);  // −1: the triangle has no area in the texture

    for (std::size_t t = 0; t < mirrored.size(); ++t) {
        const auto corner_uv = [&](std::size_t i) {
            const ModelVertex& vertex = mesh.vertices[mesh.indices[3 * t + i]];
            return mapping(vertex.uv, vertex.uv_second);
        };
        const auto uv0 = corner_uv(0);
        const auto uv1 = corner_uv(1);
        const auto uv2 = corner_uv(2);
        const double du1 = static_cast<double>(uv1[0]) - uv0[0];
        const double du2 = static_cast<double>(uv2[0]) - uv0[0];
        const double dup1 = static_cast<double>(uv0[1]) - uv1[1];  // up in the image: v grows downwards
        const double dup2 = static_cast<double>(uv0[1]) - uv2[1];
        const double area = du1 * dup2 - du2 * dup1;
        const Vector3d origin = position(mesh, 3 * t);
        const Vector3d along_u =
            (dup2 * (position(mesh, 3 * t + 1) - origin) - dup1 * (position(mesh, 3 * t + 2) - origin)) *
            (area < 0 ? -1.0 : 1.0);
        if (area == 0 || !std::isfinite(area) || along_u.norm() == 0) continue;
        mirrored[t] = area < 0 ? 1 : 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t v = mesh.indices[3 * t + i];
            const Vector3d normal = vector_of(mesh.vertices[v].normal);
            const Vector3d flat = along_u - normal * normal.dot(along_u);
            if (flat.norm() > 0) sums[mirrored[t]][v] += corner_angle(mesh, 3 * t + i) * flat.normalized();
        }
    }

    const auto finish = [&](ModelVertex& vertex, const Vector3d& sum, float w) {
        const Vector3d normal = vector_of(vertex.normal);
        const Vector3d flat = sum - normal * normal.dot(sum);
        const auto tangent = narrowed(flat.norm() > 1e-12 ? flat.normalized() : normal.unitOrthogonal());
        vertex.tangent = {tangent[0], tangent[1], tangent[2], w};
    };
    const std::size_t vertex_count = mesh.vertices.size();
    std::vector<std::uint32_t> twin(vertex_count, 0);  // the mirrored copy of a vertex used both ways; 0: none yet
    std::vector<char> used_as_is(vertex_count, 0);
    for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
        if (mirrored[corner / 3] != 1) used_as_is[mesh.indices[corner]] = 1;
    }
    for (std::size_t v = 0; v < vertex_count; ++v) {
        if (used_as_is[v]) {
            finish(mesh.vertices[v], sums[0][v], 1);
        } else {
            finish(mesh.vertices[v], sums[1][v], -1);
        }
    }
    for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
        const std::uint32_t v = mesh.indices[corner];
        if (mirrored[corner / 3] != 1 || !used_as_is[v]) continue;
        if (twin[v] == 0) {
            twin[v] = static_cast<std::uint32_t>(mesh.vertices.size());
            ModelVertex copy = mesh.vertices[v];
            finish(copy, sums[1][v], -1);
            mesh.vertices.push_back(copy);
        }
        mesh.indices[corner] = twin[v];
    }
}

std::size_t repair_tangents(ModelMesh& mesh, const UvMapping& mapping) {
    const auto is_bad = [](const ModelVertex& vertex) {
        const Vector3d normal = vector_of(vertex.normal);
        const Vector3d tangent(vertex.tangent[0], vertex.tangent[1], vertex.tangent[2]);
        return (tangent - normal * normal.dot(tangent)).norm() < 1e-3;
    };
    std::vector<std::uint32_t> bad;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        if (is_bad(mesh.vertices[v])) bad.push_back(v);
    }
    if (bad.empty()) return 0;
    ModelMesh computed = mesh;
    compute_tangents(computed, mapping);
    for (const std::uint32_t v : bad) mesh.vertices[v].tangent = computed.vertices[v].tangent;
    return bad.size();
}

void weld(ModelMesh& mesh) {
    static_assert(sizeof(ModelVertex) == 18 * sizeof(float), "no padding: vertices compare by their bytes");
    const auto bytes_of = [](const ModelVertex& vertex) {
        return std::string_view(reinterpret_cast<const char*>(&vertex), sizeof(ModelVertex));
    };
    std::unordered_map<std::string_view, std::uint32_t> numbers;
    numbers.reserve(mesh.vertices.size());
    std::vector<ModelVertex> kept;
    for (std::uint32_t& index : mesh.indices) {
        const ModelVertex& vertex = mesh.vertices[index];
        const auto [entry, is_new] = numbers.try_emplace(bytes_of(vertex), static_cast<std::uint32_t>(kept.size()));
        if (is_new) kept.push_back(vertex);
        index = entry->second;
    }
    mesh.vertices = std::move(kept);
}

ModelVertex middle_of_edge(const ModelVertex& a, const ModelVertex& b) {
    ModelVertex result{middle(a.position, b.position), middle(a.normal, b.normal),
                       middle(a.tangent, b.tangent),   middle(a.uv, b.uv),
                       middle(a.color, b.color),       middle(a.uv_second, b.uv_second)};
    normalize_first_three(result.normal);
    normalize_first_three(result.tangent);
    result.tangent[3] = a.tangent[3];
    return result;
}

ModelVertex back_of(const ModelVertex& vertex) {
    ModelVertex back = vertex;
    for (float& component : back.normal) component = -component;
    return back;
}

}  // namespace matchlight
