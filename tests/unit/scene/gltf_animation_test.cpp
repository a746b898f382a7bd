// Animations, skins and morph targets of glTF: poses worked out by hand, and files that are wrong.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "model_test.h"
#include "scene/model_pose.h"
#include "scene/scene_file.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;
using nlohmann::json;
using testing::HasSubstr;

/// The world's axes of a point in glTF's.
Vector3d in_world(double x, double y, double z) {
    return {x, -z, y};
}

class GltfAnimation : public ModelTest {
protected:
    /// Adds a channel of an animation, which is made where there is none.
    static void animate(GltfBuilder& builder, const char* path, const std::vector<float>& times,
                        const std::vector<float>& values, const char* interpolation = "LINEAR", int node = 0) {
        const bool is_weights = std::string(path) == "weights";
        const std::string type = is_weights ? "SCALAR" : std::string(path) == "rotation" ? "VEC4" : "VEC3";
        const std::size_t input = builder.add<float>(times, 5126, "SCALAR");
        const std::size_t output = builder.add<float>(values, 5126, type);
        if (!builder.root.contains("animations")) {
            builder.root["animations"] = {{{"name", "move"}, {"samplers", json::array()}, {"channels", json::array()}}};
        }
        json& animation = builder.root["animations"][0];
        animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
        animation["channels"].push_back(
            {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
    }
    /// A triangle whose corner at the origin follows the first joint, that at x = 1 both alike, that at y = 1 the
    /// second.
    static GltfBuilder skinned() {
        GltfBuilder builder = GltfBuilder::triangle();
        json& attributes = builder.primitive()["attributes"];
        attributes["JOINTS_0"] = builder.add<std::uint8_t>({0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, 5121, "VEC4");
        attributes["WEIGHTS_0"] = builder.add<float>({1, 0, 0, 0, 0.5F, 0.5F, 0, 0, 1, 0, 0, 0}, 5126, "VEC4");
        builder.root["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {7, 7, 7}}},
                                 {{"children", {2}}},
                                 {{"translation", {0, 0.5, 0}}}};
        builder.root["scenes"] = {{{"nodes", {0, 1}}}};
        builder.root["skins"] = {{{"joints", {1, 2}}}};
        return builder;
    }
    static void bind(GltfBuilder& builder, const Vector3d& second_joint) {
        std::vector<float> matrices(32, 0.0F);
        for (std::size_t i = 0; i < 2; ++i) {
            for (std::size_t d = 0; d < 4; ++d) matrices[16 * i + 5 * d] = 1;
        }
        for (std::size_t d = 0; d < 3; ++d)
            matrices[16 + 12 + d] = static_cast<float>(-second_joint[static_cast<int>(d)]);
        // "MAT4" has no digit where the builder looks for the components.
        const std::size_t accessor = builder.add<float>(matrices, 5126, "VEC4");
        builder.root["accessors"][accessor]["type"] = "MAT4";
        builder.root["accessors"][accessor]["count"] = 2;
        builder.root["skins"][0]["inverseBindMatrices"] = accessor;
    }
    std::vector<ModelVertex> posed(const Model& model, double time_s) {
        PosedModel poses(model, "", "model.glb");
        EXPECT_TRUE(poses.moves());
        return poses.at(time_s).at(0).vertices;
    }
    static void expect_near(const Vector3d& a, const Vector3d& b) {
        // Floats near 1, and a few roundings.
        EXPECT_LT((a - b).norm(), 1e-6) << a.transpose() << " is not " << b.transpose();
    }
};

TEST_F(GltfAnimation, AModelWithoutOneHasNoRig) {
    EXPECT_EQ(load(GltfBuilder::triangle()).rig, nullptr);
    EXPECT_FALSE(PosedModel(load(GltfBuilder::triangle()), "", "x").moves());
}

TEST_F(GltfAnimation, TranslationIsLinearBetweenKeysAndRestsBeyond) {
    GltfBuilder builder = GltfBuilder::triangle();
    animate(builder, "translation", {1, 3}, {0, 0, 0, 4, 8, 2});
    const Model model = load(builder);
    expect_near(position_of(model.meshes[0].vertices[1]), in_world(1, 0, 0));
    expect_near(position_of(posed(model, 1.5)[1]), in_world(2, 2, 0.5));
    expect_near(position_of(posed(model, 0)[1]), in_world(1, 0, 0));
    expect_near(position_of(posed(model, 9)[1]), in_world(5, 8, 2));
    EXPECT_EQ(all_warnings(), "");
}

TEST_F(GltfAnimation, RotationsTurnTheShorterWay) {
    GltfBuilder builder = GltfBuilder::triangle();
    // A quarter about z, by the quaternion of the other sign: the longer way would be three quarters.
    const float half = std::sqrt(0.5F);
    animate(builder, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, -half, -half});
    const Model model = load(builder);
    const double third = std::acos(-1.0) / 6;
    expect_near(position_of(posed(model, 1.0 / 3)[1]), in_world(std::cos(third), std::sin(third), 0));
}

TEST_F(GltfAnimation, StepsHoldAndSplinesFollowTheirTangents) {
    GltfBuilder step = GltfBuilder::triangle();
    animate(step, "translation", {0, 1}, {0, 0, 0, 4, 0, 0}, "STEP");
    expect_near(position_of(posed(load(step), 0.999)[0]), in_world(0, 0, 0));
    // In-tangent, value, out-tangent a key: from 0 with slope 0 to 4 with slope 4 in 2 s is x = t², y likewise −t²/2.
    GltfBuilder spline = GltfBuilder::triangle();
    animate(spline, "translation", {0, 2}, {9, 9, 9, 0, 0, 0, 0, 0, 0, 4, -2, 0, 4, -2, 0, 9, 9, 9}, "CUBICSPLINE");
    expect_near(position_of(posed(load(spline), 0.5)[0]), in_world(0.25, -0.125, 0));
    expect_near(position_of(posed(load(spline), 1.5)[0]), in_world(2.25, -1.125, 0));
}

TEST_F(GltfAnimation, ScaleTurnsNormalsByItsInverseAndParentsCarryTheirChildren) {
    GltfBuilder builder = GltfBuilder::triangle();
    const std::size_t normals = builder.add<float>({0.6F, 0, 0.8F, 0.6F, 0, 0.8F, 0.6F, 0, 0.8F}, 5126, "VEC3");
    builder.primitive()["attributes"]["NORMAL"] = normals;
    builder.root["nodes"] = {{{"children", {1}}, {"translation", {0, 0, 3}}}, {{"mesh", 0}}};
    animate(builder, "scale", {0, 1}, {1, 1, 1, 2, 1, 1});
    const std::vector<ModelVertex> vertices = posed(load(builder), 1);
    expect_near(position_of(vertices[1]), in_world(2, 0, 3));
    expect_near(normal_of(vertices[1]), in_world(0.3, 0, 0.8).normalized());
}

TEST_F(GltfAnimation, SkinsBlendTheirJointsAndForgetTheirNode) {
    GltfBuilder builder = skinned();
    bind(builder, {0, 0.5, 0});
    const Model rest = load(builder);
    expect_near(position_of(rest.meshes[0].vertices[2]), in_world(0, 1, 0));
    // The second joint turns a quarter about z through (0, ½, 0).
    const float half = std::sqrt(0.5F);
    animate(builder, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, half, half}, "LINEAR", 2);
    const std::vector<ModelVertex> vertices = posed(load(builder), 1);
    expect_near(position_of(vertices[0]), in_world(0, 0, 0));
    expect_near(position_of(vertices[2]), in_world(-0.5, 0.5, 0));
    // (1, 0, 0) turned about that point is (½, 3/2, 0); half of it and half of where it was.
    expect_near(position_of(vertices[1]), in_world(0.75, 0.75, 0));
    expect_near(normal_of(vertices[1]), in_world(0, 0, 1));
}

TEST_F(GltfAnimation, MissingInverseBindMatricesAreTheIdentity) {
    const Model model = load(skinned());
    expect_near(position_of(model.meshes[0].vertices[2]), in_world(0, 1.5, 0));
}

TEST_F(GltfAnimation, MorphTargetsAddByTheirWeights) {
    GltfBuilder builder = GltfBuilder::triangle();
    const std::size_t up = builder.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, 5126, "VEC3");
    const std::size_t aside = builder.add<float>({2, 0, 0, 2, 0, 0, 2, 0, 0}, 5126, "VEC3");
    const std::size_t tilt = builder.add<float>({1, 0, 0, 1, 0, 0, 1, 0, 0}, 5126, "VEC3");
    builder.primitive()["targets"] = {{{"POSITION", up}}, {{"POSITION", aside}, {"NORMAL", tilt}}};
    builder.root["meshes"][0]["weights"] = {0.5, 0};
    const Model still = load(builder);
    EXPECT_FALSE(PosedModel(still, "", "x").moves());
    expect_near(position_of(still.meshes[0].vertices[1]), in_world(1, 0, 0.5));
    animate(builder, "weights", {0, 1}, {0, 0, 1, 1});
    const std::vector<ModelVertex> vertices = posed(load(builder), 0.5);
    expect_near(position_of(vertices[1]), in_world(2, 0, 0.5));
    expect_near(normal_of(vertices[1]), in_world(0.5, 0, 1).normalized());
}

TEST_F(GltfAnimation, IsChosenByNameOrNumberAndPlayedOnTheClock) {
    GltfBuilder builder = GltfBuilder::triangle();
    animate(builder, "translation", {0, 2}, {0, 0, 0, 2, 0, 0});
    builder.root["animations"].push_back(builder.root["animations"][0]);
    builder.root["animations"][1]["name"] = "other";
    builder.root["animations"][1]["channels"] = json::array();
    const Model model = load(builder);
    EXPECT_TRUE(PosedModel(model, "move", "x").moves());
    EXPECT_TRUE(PosedModel(model, "0", "x").moves());
    EXPECT_FALSE(PosedModel(model, "other", "x").moves());
    EXPECT_FALSE(PosedModel(model, "none", "x").moves());
    try {
        PosedModel(model, "jump", "model.glb");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("it has no animation 'jump'"));
        EXPECT_THAT(error.what(), HasSubstr("0 'move', 1 'other'"));
    }
    const PosedModel poses(model, "", "x");
    EXPECT_DOUBLE_EQ(poses.animation_time_s({.name = "", .speed = 2, .start_s = 0.5}, 1), 0.5);
    EXPECT_DOUBLE_EQ(poses.animation_time_s({.name = "", .speed = -1}, 0.5), 1.5);
    EXPECT_DOUBLE_EQ(poses.animation_time_s({.name = "", .speed = 2, .loop = false}, 3), 2);
    EXPECT_DOUBLE_EQ(poses.animation_time_s({.name = "", .speed = -1, .loop = false}, 3), 0);
}

TEST_F(GltfAnimation, MirroringPlacementsStayOutwards) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.root["nodes"][0]["scale"] = {-1, 1, 1};
    const Model still = load(builder);
    animate(builder, "translation", {0, 1}, {0, 0, 0, 0, 0, 0});
    const Model moving = load(builder);
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const auto vertex_of = [&](const ModelMesh& mesh) { return mesh.vertices[mesh.indices[corner]]; };
        EXPECT_EQ(vertex_of(moving.meshes[0]).position, vertex_of(still.meshes[0]).position);
        EXPECT_EQ(vertex_of(moving.meshes[0]).normal, vertex_of(still.meshes[0]).normal);
    }
}

TEST_F(GltfAnimation, OneKeyIsAPose) {
    GltfBuilder builder = GltfBuilder::triangle();
    animate(builder, "translation", {0.5F}, {0, 4, 0});
    const Model model = load(builder);
    expect_near(position_of(posed(model, 0)[0]), in_world(0, 4, 0));
    EXPECT_DOUBLE_EQ(PosedModel(model, "", "x").animation_time_s({}, 0.75), 0.25);
}

TEST_F(GltfAnimation, WhatIsDamagedIsRepairedAndCounted) {
    GltfBuilder builder = skinned();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    builder.primitive()["attributes"]["WEIGHTS_0"] =
        builder.add<float>({0, 0, 0, 0, nan, 0.5F, 0, 0, 1, 0, 0, 0}, 5126, "VEC4");
    bind(builder, {0, 0.5, 0});
    const Model model = load(builder);
    for (const ModelVertex& vertex : model.meshes[0].vertices) EXPECT_TRUE(position_of(vertex).allFinite());
    EXPECT_THAT(all_warnings(), HasSubstr("1 weights and morph targets that are not finite, taken as 0"));
    EXPECT_THAT(all_warnings(), HasSubstr("1 vertices whose weights add to nothing follow their first joint"));
}

TEST_F(GltfAnimation, WhatCannotBeReadIsOneLine) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto moving = [](const std::vector<float>& times, const std::vector<float>& values) {
        GltfBuilder builder = GltfBuilder::triangle();
        animate(builder, "translation", times, values);
        return builder;
    };
    EXPECT_THAT(error_of(moving({1, 1}, {0, 0, 0, 1, 1, 1})), HasSubstr("its times do not ascend"));
    EXPECT_THAT(error_of(moving({0, nan}, {0, 0, 0, 1, 1, 1})), HasSubstr("not finite"));
    EXPECT_THAT(error_of(moving({0, 1}, {0, 0, 0, 1, nan, 1})), HasSubstr("not finite"));
    EXPECT_THAT(error_of(moving({0, 1}, {0, 0, 0})), HasSubstr("is not 2 values of 3 numbers for 2 times"));

    GltfBuilder joint = skinned();
    joint.primitive()["attributes"]["JOINTS_0"] =
        joint.add<std::uint8_t>({0, 0, 0, 0, 0, 2, 0, 0, 1, 0, 0, 0}, 5121, "VEC4");
    EXPECT_THAT(error_of(joint), HasSubstr("joint 2 is beyond the 2 joints of its skin"));

    GltfBuilder unbound = skinned();
    bind(unbound, {0, 0, 0});
    unbound.root["accessors"].back()["count"] = 1;
    EXPECT_THAT(error_of(unbound), HasSubstr("has 1 matrices for 2 joints"));

    GltfBuilder weightless = skinned();
    weightless.primitive()["attributes"].erase("WEIGHTS_0");
    EXPECT_THAT(error_of(weightless), HasSubstr("joints without weights"));

    GltfBuilder sampler = moving({0, 1}, {0, 0, 0, 1, 1, 1});
    sampler.root["animations"][0]["channels"][0]["sampler"] = 5;
    EXPECT_THAT(error_of(sampler), HasSubstr("sampler is 5, but there are 1 samplers"));

    GltfBuilder targets = GltfBuilder::triangle();
    targets.primitive()["targets"] = {{{"POSITION", targets.add<float>({0, 0, 1}, 5126, "VEC3")}}};
    EXPECT_THAT(error_of(targets), HasSubstr("is not one vector for each of 3 vertices"));
}

}  // namespace
}  // namespace matchlight
