// Normals, tangents and clean-up against meshes whose answers are known.
#include "scene/mesh_geometry.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "model_test.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;

ModelVertex vertex_at(double x, double y, double z, double u = 0, double v = 0) {
    return {.position = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)},
            .normal = {0, 0, 0},
            .tangent = {0, 0, 0, 0},
            .uv = {static_cast<float>(u), static_cast<float>(v)},
            .color = {1, 1, 1, 1},
            .uv_second = {}};
}

/// Two squares that share an edge on the y axis; the right one is tilted up by `angle_deg`.
ModelMesh folded(double angle_deg) {
    const double c = std::cos(angle_deg * std::numbers::pi / 180);
    const double s = std::sin(angle_deg * std::numbers::pi / 180);
    ModelMesh mesh;
    mesh.vertices = {vertex_at(-1, 0, 0), vertex_at(0, 0, 0), vertex_at(0, 1, 0),
                     vertex_at(-1, 1, 0), vertex_at(c, 0, s), vertex_at(c, 1, s)};
    mesh.indices = {0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2};
    return mesh;
}

TEST(MeshNormals, GentleFoldsAreSmoothedAndSharpOnesKept) {
    ModelMesh gentle = folded(40);
    compute_normals(gentle, 45);
    EXPECT_EQ(gentle.vertices.size(), 6u);
    // On the fold two triangles of one side (angles 90°, or 45° + 45°) meet as much of the other: the bisector.
    const double half = 20 * std::numbers::pi / 180;
    const Vector3d bisector(-std::sin(half), 0, std::cos(half));
    int on_fold = 0;
    for (const ModelVertex& vertex : gentle.vertices) {
        if (vertex.position[0] != 0) continue;
        ++on_fold;
        EXPECT_TRUE(normal_of(vertex).isApprox(bisector, 1e-6));
    }
    EXPECT_EQ(on_fold, 2);

    ModelMesh sharp = folded(50);
    compute_normals(sharp, 45);
    EXPECT_EQ(sharp.vertices.size(), 8u);  // the vertices of the fold are there twice
    for (const ModelVertex& vertex : sharp.vertices) {
        if (vertex.position[0] >= 0) continue;
        EXPECT_TRUE(normal_of(vertex).isApprox(Vector3d::UnitZ(), 1e-6));
    }
}

TEST(MeshNormals, AreThoseOfTheSurfaceOnASphere) {
    ModelMesh mesh = make_shape("sphere", "").meshes[0];
    for (ModelVertex& vertex : mesh.vertices) vertex.normal = {0, 0, 0};
    compute_normals(mesh, 45);
    double worst = 0;
    for (const ModelVertex& vertex : mesh.vertices) {
        worst = std::max(worst, (normal_of(vertex) - position_of(vertex).normalized()).norm());
    }
    EXPECT_LT(worst, 2e-3);  // a tenth of the step between neighbours, 2π/192
}

TEST(MeshNormals, AFanOfManyTrianglesTakesNoQuadraticTime) {
    ModelMesh mesh;
    mesh.vertices.push_back(vertex_at(0, 0, 1));
    constexpr std::uint32_t count = 200000;
    for (std::uint32_t i = 0; i < count; ++i) {
        const double angle = 2 * std::numbers::pi * i / count;
        mesh.vertices.push_back(vertex_at(1000 * std::cos(angle), 1000 * std::sin(angle), 0));
        mesh.indices.insert(mesh.indices.end(), {0, 1 + i, 1 + (i + 1) % count});
    }
    compute_normals(mesh, 45);
    for (const ModelVertex& vertex : mesh.vertices) EXPECT_GT(vertex.normal[2], 0.99f);
}

TEST(MeshNormals, BadOnesAreReplaced) {
    ModelMesh mesh = folded(0);
    for (ModelVertex& vertex : mesh.vertices) vertex.normal = {0, 0, 2};
    mesh.vertices[0].normal = {0, 0, 0};
    mesh.vertices[1].normal = {std::numeric_limits<float>::quiet_NaN(), 0, 0};
    EXPECT_EQ(repair_normals(mesh), 2u);
    for (const ModelVertex& vertex : mesh.vertices) EXPECT_TRUE(normal_of(vertex).isApprox(Vector3d::UnitZ(), 1e-6));
}

TEST(MeshTriangles, WithoutAreaOrFinitePositionsAreDropped) {
    ModelMesh mesh = folded(0);
    mesh.vertices.push_back(vertex_at(std::numeric_limits<double>::quiet_NaN(), 0, 0));
    mesh.vertices.push_back(vertex_at(std::numeric_limits<double>::infinity(), 0, 0));
    mesh.vertices.push_back(vertex_at(-3, 0, 0));
    const std::vector<std::uint32_t> bad = {0, 0, 1, 0, 1, 6, 0, 1, 7, 0, 1, 8};  // the last: three on a line
    mesh.indices.insert(mesh.indices.end(), bad.begin(), bad.end());
    EXPECT_EQ(drop_bad_triangles(mesh), 4u);
    EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2}));
}

TEST(MeshTriangles, ThinAndTinyOnesStay) {
    ModelMesh mesh;
    mesh.vertices = {vertex_at(0, 0, 0), vertex_at(1, 0, 0), vertex_at(0.5, 1e-6, 0), vertex_at(1e-12, 0, 0),
                     vertex_at(0, 1e-12, 0)};
    mesh.indices = {0, 1, 2, 0, 3, 4};
    EXPECT_EQ(drop_bad_triangles(mesh), 0u);
}

TEST(MeshTangents, FollowTheTexture) {
    // A unit square seen from above with the picture upright: u along x, v against y.
    ModelMesh mesh;
    mesh.vertices = {vertex_at(0, 0, 0, 0, 1), vertex_at(1, 0, 0, 1, 1), vertex_at(1, 1, 0, 1, 0),
                     vertex_at(0, 1, 0, 0, 0)};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    for (ModelVertex& vertex : mesh.vertices) vertex.normal = {0, 0, 1};
    compute_tangents(mesh);
    EXPECT_EQ(mesh.vertices.size(), 4u);
    for (const ModelVertex& vertex : mesh.vertices) {
        EXPECT_TRUE(tangent_of(vertex).isApprox(Vector3d::UnitX(), 1e-6));
        // cross(n, t)·w is +y: up in the picture.
        EXPECT_EQ(vertex.tangent[3], 1);
    }
}

TEST(MeshTangents, MirroredHalvesArePartedAtTheSeam) {
    // Two squares beside each other; the right one shows the picture mirrored, and the seam's vertices are shared.
    ModelMesh mesh;
    mesh.vertices = {vertex_at(-1, 0, 0, 0, 1), vertex_at(0, 0, 0, 1, 1), vertex_at(0, 1, 0, 1, 0),
                     vertex_at(-1, 1, 0, 0, 0), vertex_at(1, 0, 0, 0, 1), vertex_at(1, 1, 0, 0, 0)};
    mesh.indices = {0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2};
    for (ModelVertex& vertex : mesh.vertices) vertex.normal = {0, 0, 1};
    compute_tangents(mesh);
    EXPECT_EQ(mesh.vertices.size(), 8u);
    for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
        const ModelVertex& vertex = mesh.vertices[mesh.indices[corner]];
        const double side = corner < 6 ? 1 : -1;
        EXPECT_TRUE(tangent_of(vertex).isApprox(side * Vector3d::UnitX(), 1e-6));
        EXPECT_EQ(vertex.tangent[3], static_cast<float>(side));  // up in the picture is +y on both sides
    }
}

TEST(MeshTangents, WithoutAreaInTheTextureAreStillUnitVectors) {
    ModelMesh mesh = folded(0);
    for (ModelVertex& vertex : mesh.vertices) vertex.normal = {0, 0, 1};
    compute_tangents(mesh);
    for (const ModelVertex& vertex : mesh.vertices) {
        EXPECT_NEAR(tangent_of(vertex).norm(), 1, 1e-6);
        EXPECT_NEAR(tangent_of(vertex).z(), 0, 1e-6);
    }
}

TEST(MeshWelding, KeepsDifferentVerticesApart) {
    ModelMesh mesh;
    mesh.vertices = {vertex_at(0, 0, 0), vertex_at(1, 0, 0),    vertex_at(0, 1, 0),
                     vertex_at(0, 0, 0), vertex_at(1e-9, 0, 0), vertex_at(5, 5, 5)};
    mesh.indices = {0, 1, 2, 3, 1, 2, 4, 1, 2};
    weld(mesh);
    EXPECT_EQ(mesh.vertices.size(), 4u);  // 3 is 0 again; 4 is near but another; 5 is not used
    EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 1, 2, 3, 1, 2}));
}

}  // namespace
}  // namespace matchlight
