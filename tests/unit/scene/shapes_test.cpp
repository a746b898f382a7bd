// The built-in shapes: known volumes, normals that are those of the surface, texture coordinates seen the right way.
#include <cmath>
#include <numbers>

#include "model_test.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;

double area_of(const Model& model) {
    double area = 0;
    for (const ModelMesh& mesh : model.meshes) {
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            const Vector3d a = position_of(mesh.vertices[mesh.indices[i]]);
            area += (position_of(mesh.vertices[mesh.indices[i + 1]]) - a)
                        .cross(position_of(mesh.vertices[mesh.indices[i + 2]]) - a)
                        .norm() /
                    2;
        }
    }
    return area;
}

class Shapes : public testing::TestWithParam<std::string> {};

TEST_P(Shapes, FaceOutwardsWithUnitNormalsAndTangents) {
    const Model model = make_shape(GetParam(), "scene.toml");
    ASSERT_EQ(model.meshes.size(), 1u);
    const ModelMesh& mesh = model.meshes[0];
    for (const ModelVertex& vertex : mesh.vertices) {
        EXPECT_NEAR(normal_of(vertex).norm(), 1, 1e-6);
        EXPECT_NEAR(tangent_of(vertex).norm(), 1, 1e-6);
        EXPECT_NEAR(tangent_of(vertex).dot(normal_of(vertex)), 0, 1e-6);
        EXPECT_TRUE(vertex.uv[0] >= 0 && vertex.uv[0] <= 1 && vertex.uv[1] >= 0 && vertex.uv[1] <= 1);
        EXPECT_EQ(vertex.tangent[3], 1);  // no shape shows its texture mirrored
    }
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const ModelVertex& a = mesh.vertices[mesh.indices[i]];
        const Vector3d face = (position_of(mesh.vertices[mesh.indices[i + 1]]) - position_of(a))
                                  .cross(position_of(mesh.vertices[mesh.indices[i + 2]]) - position_of(a));
        EXPECT_GT(face.dot(normal_of(a)), 0) << "triangle " << i / 3;
    }
}

INSTANTIATE_TEST_SUITE_P(All, Shapes, testing::Values("sphere", "box", "plane", "torus", "cylinder"),
                         [](const auto& test) { return test.param; });

// Tolerance: a circle of 192 chords encloses 2π²/(3·192²) = 1.8e-4 less area than the true one; volumes of surfaces
// curved both ways lose twice that.
constexpr double tessellation = 5e-4;

TEST(Shapes, HaveTheVolumesOfTheirFormulas) {
    const double pi = std::numbers::pi;
    EXPECT_NEAR(signed_volume(make_shape("sphere", "")) / (pi / 6), 1, tessellation);
    EXPECT_NEAR(signed_volume(make_shape("box", "")), 1, 1e-6);
    EXPECT_NEAR(signed_volume(make_shape("torus", "")) / (2 * pi * pi * 0.35 * 0.15 * 0.15), 1,
                2e-3);  // tube: 96 chords
    EXPECT_NEAR(signed_volume(make_shape("cylinder", "")) / (pi / 4), 1, tessellation);
    EXPECT_NEAR(area_of(make_shape("plane", "")), 1, 1e-6);
    EXPECT_NEAR(area_of(make_shape("box", "")), 6, 1e-6);
}

TEST(Shapes, AreWhereTheySay) {
    for (const char* name : {"sphere", "box", "cylinder"}) {
        const Model model = make_shape(name, "");
        EXPECT_TRUE(model.bounds_m.min().isApprox(Vector3d(-0.5, -0.5, -0.5), 1e-6)) << name;
        EXPECT_TRUE(model.bounds_m.max().isApprox(Vector3d(0.5, 0.5, 0.5), 1e-6)) << name;
    }
    EXPECT_NEAR(make_shape("plane", "").bounds_m.sizes().z(), 0, 0);
    EXPECT_TRUE(make_shape("torus", "").bounds_m.max().isApprox(Vector3d(0.5, 0.5, 0.15), 1e-6));
}

TEST(Shapes, SphereNormalsPointFromTheCentre) {
    const Model shown = make_shape("sphere", "");
    for (const ModelVertex& vertex : shown.meshes[0].vertices) {
        EXPECT_TRUE(normal_of(vertex).isApprox(2 * position_of(vertex), 1e-6));
    }
}

TEST(Shapes, PlaneShowsItsTextureUprightSeenFromAbove) {
    const Model shown = make_shape("plane", "");
    for (const ModelVertex& vertex : shown.meshes[0].vertices) {
        EXPECT_NEAR(vertex.uv[0], vertex.position[0] + 0.5, 1e-6);
        EXPECT_NEAR(vertex.uv[1], 0.5 - vertex.position[1], 1e-6);
        EXPECT_TRUE(tangent_of(vertex).isApprox(Vector3d::UnitX(), 1e-6));
    }
}

TEST(Shapes, UnknownOnesNameTheNearest) {
    try {
        make_shape("spere", "scene.toml");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "scene.toml: unknown shape 'spere'; did you mean 'sphere'?");
    }
}

}  // namespace
}  // namespace matchlight
