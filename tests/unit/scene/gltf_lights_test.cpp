// KHR_lights_punctual: lights where their nodes are, and what is refused.
#include "core/transforms.h"
#include "model_test.h"

namespace matchlight {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class GltfLights : public ModelTest {
protected:
    static GltfBuilder with_lights(const json& lights, const json& node) {
        GltfBuilder builder = GltfBuilder::triangle();
        builder.root["extensionsUsed"] = {"KHR_lights_punctual"};
        builder.root["extensionsRequired"] = {"KHR_lights_punctual"};
        builder.root["extensions"]["KHR_lights_punctual"]["lights"] = lights;
        builder.root["nodes"].push_back(node);
        builder.root["scenes"][0]["nodes"] = {0, 1};
        return builder;
    }
    static json holding(int light, json node = json::object()) {
        node["extensions"]["KHR_lights_punctual"]["light"] = light;
        return node;
    }
};

TEST_F(GltfLights, StandWhereTheirNodesAreAndShineAlongMinusZ) {
    const double half = std::sqrt(0.5);
    GltfBuilder builder = with_lights({{{"type", "point"}},
                                       {{"type", "spot"},
                                        {"color", {1, 0.5, 0.25}},
                                        {"intensity", 20},
                                        {"range", 5},
                                        {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.5}}}}},
                                      {{"translation", {1, 2, 3}}, {"scale", {2, 2, 2}}, {"children", {2}}});
    // A quarter turn about x: −z becomes +y.
    builder.root["nodes"].push_back(holding(1, {{"translation", {1, 0, 0}}, {"rotation", {half, 0, 0, half}}}));
    const Model model = load(builder);
    EXPECT_EQ(all_warnings(), "");
    ASSERT_EQ(model.lamps.size(), 1U);
    const ModelLamp& lamp = model.lamps[0];
    EXPECT_EQ(lamp.node, 2U);
    EXPECT_EQ(lamp.lamp.type, LampType::spot);
    EXPECT_EQ(lamp.lamp.intensity, 20);
    EXPECT_EQ(lamp.lamp.color, Eigen::Vector3d(1, 0.5, 0.25));
    EXPECT_EQ(lamp.lamp.range_m, 5.0);
    EXPECT_NEAR(lamp.lamp.inner_cone_deg, 0.1 * 180 / EIGEN_PI, 1e-9);
    EXPECT_NEAR(lamp.lamp.outer_cone_deg, 0.5 * 180 / EIGEN_PI, 1e-9);
    // (1 + 2, 2, 3) with y up is (3, −3, 2) with z up; +y of the file is up.
    EXPECT_LT((lamp.model_from_node.topRightCorner<3, 1>() - Eigen::Vector3d(3, -3, 2)).norm(), 1e-12);
    const Eigen::Vector3d forward = -lamp.model_from_node.col(2).head<3>().normalized();
    EXPECT_LT((forward - Eigen::Vector3d(0, 0, 1)).norm(), 1e-12);
}

TEST_F(GltfLights, ThatAreWrongAreRefused) {
    const auto refusal = [&](const json& light) { return error_of(with_lights(json::array({light}), holding(0))); };
    EXPECT_THAT(refusal({{"type", "area"}}), HasSubstr("lights[0].type is 'area'"));
    EXPECT_THAT(refusal({{"type", "point"}, {"intensity", -1}}), HasSubstr("lights[0].intensity is -1"));
    EXPECT_THAT(refusal({{"type", "point"}, {"range", 0}}), HasSubstr("lights[0].range is 0"));
    EXPECT_THAT(refusal({{"type", "spot"}, {"spot", {{"outerConeAngle", 2}}}}), HasSubstr("spot.outerConeAngle is 2"));
    EXPECT_THAT(refusal({{"type", "spot"}, {"spot", {{"innerConeAngle", 0.6}, {"outerConeAngle", 0.5}}}}),
                HasSubstr("spot.innerConeAngle is 0.6"));
    EXPECT_THAT(refusal({{"type", "point"}, {"color", {1, 1}}}), HasSubstr("color"));
    EXPECT_THAT(error_of(with_lights({{{"type", "point"}}}, holding(3))),
                HasSubstr("nodes[1] holds light 3, and there are 1"));
    EXPECT_THAT(error_of(with_lights("none", holding(0))), HasSubstr("lights is no array"));
}

}  // namespace
}  // namespace matchlight
