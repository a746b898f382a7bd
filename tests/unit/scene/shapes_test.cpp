// The built-in shapes: known volumes, normals that are those of the surface, texture coordinates seen the right way.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "media/image_io.h"
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

INSTANTIATE_TEST_SUITE_P(All, Shapes, testing::Values("sphere", "box", "plane", "torus", "cylinder", "cone", "teapot"),
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
    EXPECT_NEAR(signed_volume(make_shape("cone", "")) / (pi / 12), 1, tessellation);
    EXPECT_NEAR(area_of(make_shape("cone", "")) / (pi / 4 * (1 + std::sqrt(5.0))), 1, tessellation);
    EXPECT_NEAR(area_of(make_shape("plane", "")), 1, 1e-6);
    EXPECT_NEAR(area_of(make_shape("box", "")), 6, 1e-6);
}

TEST(Shapes, AreWhereTheySay) {
    for (const char* name : {"sphere", "box", "cylinder", "cone"}) {
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

TEST(Shapes, ConeNormalsStandAcrossItsSide) {
    const Model shown = make_shape("cone", "");
    for (const ModelVertex& vertex : shown.meshes[0].vertices) {
        const Vector3d normal = normal_of(vertex);
        if (normal.z() < 0) {
            EXPECT_TRUE(normal.isApprox(-Vector3d::UnitZ(), 1e-6));
            continue;
        }
        const Vector3d to_tip = Vector3d(0, 0, 0.5) - position_of(vertex);
        EXPECT_NEAR(normal.dot(to_tip), 0, 1e-6);
        EXPECT_NEAR(normal.z(), 1 / std::sqrt(5.0), 1e-6);
    }
}

TEST(Teapot, IsOneLongAndMirrorsItself) {
    const Model pot = make_shape("teapot", "");
    const Vector3d size = pot.bounds_m.sizes();
    EXPECT_NEAR(size.x(), 1, 1e-4);
    // Newell's belly is 2 in radius where 6.4341 is the length, its height 3.15.
    EXPECT_NEAR(size.y(), 4 / 6.4341, 1e-5);
    EXPECT_NEAR(size.z(), 3.15 / 6.4341, 1e-5);
    EXPECT_NEAR(pot.bounds_m.min().y() + pot.bounds_m.max().y(), 0, 1e-6);
    EXPECT_NEAR(pot.bounds_m.min().z() + pot.bounds_m.max().z(), 0, 1e-6);
    EXPECT_GT(pot.bounds_m.max().x(), -pot.bounds_m.min().x());  // the spout
}

TEST(Teapot, NormalsAtTheKnobsTopAndInTheBottomsMiddleAreTheAxis) {
    const Model pot = make_shape("teapot", "");
    int top = 0, bottom = 0;
    for (const ModelVertex& vertex : pot.meshes[0].vertices) {
        const Vector3d place = position_of(vertex);
        if (place.head<2>().norm() > 1e-6) continue;
        const bool is_top = place.z() > 0;
        (is_top ? top : bottom) += 1;
        EXPECT_TRUE(normal_of(vertex).isApprox(is_top ? Vector3d(0, 0, 1) : Vector3d(0, 0, -1), 1e-6));
    }
    EXPECT_GT(top, 0);
    EXPECT_GT(bottom, 0);
}

TEST(Teapot, NormalsAreThoseOfNeighbouringTriangles) {
    const Model pot = make_shape("teapot", "");
    const ModelMesh& mesh = pot.meshes[0];
    double least = 1;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const auto corner = [&](std::size_t k) -> const ModelVertex& { return mesh.vertices[mesh.indices[i + k]]; };
        const Vector3d face = (position_of(corner(1)) - position_of(corner(0)))
                                  .cross(position_of(corner(2)) - position_of(corner(0)))
                                  .normalized();
        for (std::size_t k = 0; k < 3; ++k) least = std::min(least, face.dot(normal_of(corner(k))));
    }
    // At its tightest, the spout's lip turns by 40° in one row of triangles; a flipped patch would be at −1.
    EXPECT_GT(least, 0.9);
}

/// Whether each edge is walked as often one way as the other, corners at one place taken as one.
bool is_closed(const ModelMesh& mesh) {
    std::map<std::array<float, 6>, int> edges;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto& a = mesh.vertices[mesh.indices[i + k]].position;
            const auto& b = mesh.vertices[mesh.indices[i + (k + 1) % 3]].position;
            ++edges[{a[0], a[1], a[2], b[0], b[1], b[2]}];
            --edges[{b[0], b[1], b[2], a[0], a[1], a[2]}];
        }
    }
    return std::all_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second == 0; });
}

TEST(Shapes, AreClosedButForThePlaneAndThePotsHandleAndSpout) {
    for (const char* name : {"sphere", "box", "torus", "cylinder", "cone"}) {
        EXPECT_TRUE(is_closed(make_shape(name, "").meshes[0])) << name;
    }
    EXPECT_FALSE(is_closed(make_shape("plane", "").meshes[0]));
    const ModelMesh pot = make_shape("teapot", "").meshes[0];
    EXPECT_FALSE(is_closed(pot));
    // Body, lid and bottom come first, but for what has no area at the knob's top and in the bottom's middle.
    ModelMesh body = pot;
    body.indices.resize(3 * 192 * (2 * (24 + 24 + 1 + 16 + 16 + 24 + 12) - 2));
    EXPECT_TRUE(is_closed(body));
    Model solid;
    solid.meshes.push_back(body);
    // The integral of r² over the height of Newell's profiles, times the area of a unit circle of his four quarters
    // (1.0045 π), over the cube of the length; rows are 12 to 24 chords of curves that turn by up to half a circle.
    EXPECT_NEAR(signed_volume(solid) / 0.094802, 1, 2e-3);
}

TEST_F(ModelTest, ATextureOfTheScenesTakesTheBaseColoursPlace) {
    write_png8(folder_ / "red.png", Image8(2, 2, 3, 128));
    Model box = make_shape("box", "scene.toml");
    box.materials[0].base_color = {0.5F, 0.25F, 0, 0.75F};
    set_base_color_texture(box, folder_ / "red.png");
    ASSERT_EQ(box.textures.size(), 1u);
    EXPECT_EQ(box.textures[0].rgba.pixel(1, 1)[0], 128);
    EXPECT_EQ(box.materials[0].texture(MaterialSlot::base_color), 0);
    EXPECT_EQ(box.materials[0].base_color, (std::array<float, 4>{1, 1, 1, 0.75F}));
    write("text.png", "no picture");
    EXPECT_THROW(set_base_color_texture(box, folder_ / "text.png"), InputError);
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
