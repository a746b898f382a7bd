// Analytic lights, classic shading and depth cueing in whole frames: what the plate gets of them, and what is left out.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "compositor/probe_lamps.h"
#include "compositor_shot.h"
#include "lighting/probe.h"
#include "render/lamps.h"

namespace matchlight::test {
namespace {

class LampScene : public CompositorTest {
protected:
    static LampSettings lamp(bool in_footage) {
        return {.type = LampType::point,
                .color = {1, 0.8, 0.6},
                .intensity = 0.3,
                .position_m = {0.1, 0, 0.3},
                .in_footage = in_footage};
    }
    static Shot lit(bool in_footage, bool with_ball = true) {
        Shot shot = make_shot();
        if (!with_ball) shot.scene.objects.clear();
        shot.scene.lamps = {lamp(in_footage)};
        return shot;
    }
    CompositedFrame with_layers(const Shot& shot) {
        Compositor compositor(context(), shot.scene, shot.solve, {.quality = shot.scene.quality, .layers = true},
                              warnings_);
        CompositedFrame frame = compositor.composite(grey_plate(320, 180, plate_luma_));
        reports_ = compositor.reports();
        return frame;
    }
    /// Where a plate pixel sees the table.
    static Eigen::Vector3d on_table(const Shot& shot, int x, int y) {
        const RigidTransform world_from_camera = shot.solve.frames[0].camera_from_world->inverse();
        const Eigen::Vector2d normalized = shot.solve.camera.normalized_from_pixel(Eigen::Vector2d(x, y));
        const Eigen::Vector3d ray = world_from_camera.linear() * normalized.homogeneous();
        const Eigen::Vector3d eye = world_from_camera.translation();
        return eye - eye.z() / ray.z() * ray;
    }
    Eigen::Vector3d probe_irradiance(const Shot& shot) {
        const ProbeSettings& settings = *shot.scene.probe;
        return irradiance(placed(load_probe(settings.path, settings.mapping, warnings_), settings.placement),
                          Eigen::Vector3d::UnitZ());
    }
    void SetUp() override { warnings_.set_quiet(true); }

    Warnings warnings_;
};

/// A glTF file that is a tiny triangle and point lights of 1 candela, 0.3 m above its origin.
std::filesystem::path save_model_with_lamps(int count) {
    std::string nodes = R"({"mesh": 0})", indices = "0";
    for (int i = 1; i <= count; ++i) {
        nodes += R"(, {"translation": [0, 0.3, 0], "extensions": {"KHR_lights_punctual": {"light": 0}}})";
        indices += fmt::format(", {}", i);
    }
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / fmt::format("matchlight_lamps_{}_{}.gltf", count, getpid());
    std::ofstream(path) << R"({"asset": {"version": "2.0"}, "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point"}]}},
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAbxKDOgAAAAAAAAAAAAAAAG8SgzoAAAAA"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                       "min": [0, 0, 0], "max": [0.001, 0.001, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [)" << nodes
                        << R"(], "scenes": [{"nodes": [)" << indices << "]}]}";
    return path;
}

TEST_F(LampScene, LightsOfAModelLightTheTableAsThoseOfTheSceneDo) {
    Shot shot = lit(false, false);
    shot.scene.lamps[0].color = {1, 1, 1};
    shot.scene.lamps[0].intensity = 0.3;
    shot.scene.lamps[0].position_m = {0, 0, 0.3};
    const CompositedFrame by_scene = with_layers(shot);
    shot.scene.lamps.clear();
    ObjectSettings holder;
    holder.model = save_model_with_lamps(1);
    holder.name = "holder";
    holder.casts_shadow = false;
    holder.lights = 0.3;
    shot.scene.objects = {holder};
    const CompositedFrame by_model = with_layers(shot);
    std::filesystem::remove(holder.model);
    const Region both = by_scene.layers->region.intersected(by_model.layers->region);
    ASSERT_GT(both.width * both.height, 1000);
    double most = 1;
    for (int y = both.y; y < both.y + both.height; y += 7) {
        for (int x = both.x; x < both.x + both.width; x += 7) {
            const Region& a = by_scene.layers->region;
            const Region& b = by_model.layers->region;
            const float one = by_scene.layers->shadow.at(x - a.x, y - a.y, 1);
            most = std::max<double>(most, one);
            EXPECT_NEAR(by_model.layers->shadow.at(x - b.x, y - b.y, 1), one, 1e-4) << x << " " << y;
        }
    }
    EXPECT_GT(most, 1.05) << "the lamp is seen";
}

TEST_F(LampScene, MoreLampsThanThereIsRoomForAreToldOf) {
    Shot shot = make_shot();
    ObjectSettings holder;
    holder.model = save_model_with_lamps(40);
    holder.name = "holder";
    shot.scene.objects = {holder};
    with_layers(shot);
    std::filesystem::remove(holder.model);
    const std::vector<Warnings::Entry> said = warnings_.entries();
    EXPECT_TRUE(std::ranges::any_of(said, [](const Warnings::Entry& entry) {
        return entry.text.find("40 lights with those of the models, of which the last 8 are left out") !=
               std::string::npos;
    }));
}

TEST_F(LampScene, AVirtualLampLightsTheTableByItsShareOfTheLight) {
    const Shot shot = lit(false, false);
    const CompositedFrame frame = with_layers(shot);
    ASSERT_TRUE(frame.layers);
    const FrameLayers& layers = *frame.layers;
    const Eigen::Vector3d probe = probe_irradiance(shot);
    int checked = 0;
    double most = 0;
    for (int y = 30; y < 180; y += 30) {
        for (int x = 20; x < 320; x += 40) {
            if (!layers.region.contains(x, y)) continue;
            const LampArrival arrival = lamp_arrival(shot.scene.lamps[0], on_table(shot, x, y));
            for (int c = 0; c < 3; ++c) {
                const double brought = arrival.to_lamp.z() * arrival.irradiance[c] / probe[c];
                // The lens is a grid of nodes, good to a thousandth of a pixel.
                EXPECT_NEAR(layers.shadow.at(x - layers.region.x, y - layers.region.y, c), 1 + brought, 2e-3 * brought);
                most = std::max(most, brought);
            }
            ++checked;
        }
    }
    EXPECT_GT(checked, 30);
    EXPECT_GT(most, 0.2);
}

TEST_F(LampScene, ALampOfTheFootageChangesThePlateOnlyWhereObjectsStandInIt) {
    const CompositedFrame empty = composite(lit(true, false), true);
    EXPECT_TRUE(std::ranges::none_of(empty.touched.samples(), [](std::uint8_t touched) { return touched != 0; }));
    const auto darkest = [](const FrameLayers& layers) { return *std::ranges::min_element(layers.shadow.samples()); };
    const auto brightest = [](const FrameLayers& layers) { return *std::ranges::max_element(layers.shadow.samples()); };
    const CompositedFrame plain = with_layers(make_shot()), real = with_layers(lit(true));
    EXPECT_LT(darkest(*real.layers), darkest(*plain.layers));
    EXPECT_LE(brightest(*real.layers), 1);
    // Virtual, it casts a shadow too: into its own light.
    EXPECT_GT(brightest(*with_layers(lit(false)).layers), 1);
}

TEST_F(LampScene, WithoutAProbeTheLampsAreAllTheLight) {
    Shot shot = lit(true);
    shot.scene.probe.reset();
    const CompositedFrame frame = with_layers(shot);
    ASSERT_TRUE(frame.layers);
    EXPECT_LT(*std::ranges::min_element(frame.layers->shadow.samples()), 1e-3) << "nothing else lights the shadow";
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(LampScene, WhereNothingCastsALampReachesEverything) {
    for (const LampType type : {LampType::directional, LampType::point, LampType::spot}) {
        Shot shot = lit(false);
        shot.scene.lamps[0].type = type;
        shot.scene.objects[0].casts_shadow = false;
        const CompositedFrame no_caster = composite(shot, true);
        shot.scene.lamps[0].casts_shadow = false;
        const CompositedFrame no_shadow = composite(shot, true);
        EXPECT_TRUE(std::ranges::equal(no_caster.rgb16().samples(), no_shadow.rgb16().samples()))
            << static_cast<int>(type);
    }
}

TEST_F(LampScene, LampsAreLeftOutWhereThereAreNoneAndOneWithoutLightChangesNoBit) {
    const CompositedFrame without = composite(make_shot(), true);
    EXPECT_FALSE(was_drawn("shadow/of lamps"));
    for (const bool in_footage : {false, true}) {
        Shot dark = lit(in_footage);
        dark.scene.lamps[0].intensity = 0;
        const CompositedFrame drawn = composite(dark, true);
        EXPECT_TRUE(std::ranges::equal(drawn.rgb16().samples(), without.rgb16().samples())) << in_footage;
    }
}

TEST_F(LampScene, ALampThatMovesIsTakenAsByACompositorMadeOfIt) {
    Shot shot = lit(false);
    const auto rgb = [](const CompositedFrame& frame) {
        const Image16 picture = frame.rgb16();
        return std::vector<std::uint16_t>(picture.samples().begin(), picture.samples().end());
    };
    Compositor compositor(context(), shot.scene, shot.solve, {.quality = shot.scene.quality}, warnings_);
    const auto before = rgb(compositor.composite(grey_plate(320, 180)));
    shot.scene.lamps[0].position_m.x() = -0.1;
    shot.scene.lamps[0].radius_m = 0.02;
    ASSERT_TRUE(compositor.set_scene(shot.scene));
    const auto after = rgb(compositor.composite(grey_plate(320, 180)));
    EXPECT_FALSE(before == after);
    EXPECT_TRUE(after == rgb(composite(shot, true)));
}

TEST_F(LampScene, DrawnObjectsAreLayersLikeOthers) {
    Shot shot = make_shot();
    shot.scene.objects[0].material.shading = {
        .model = ShadingModel::cartoon, .tones = 2, .outline_px = 2, .outline_color = {0.1, 0, 0}};
    const CompositedFrame frame = with_layers(shot);
    ASSERT_TRUE(frame.layers);
    const FrameLayers& layers = *frame.layers;
    int covered = 0;
    for (int y = 0; y < layers.region.height; ++y) {
        for (int x = 0; x < layers.region.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                const double composited =
                    layers.plate.at(x, y, c) * layers.shadow.at(x, y, c) * (1 - layers.alpha.at(x, y)) +
                    layers.virtual_rgba.at(x, y, c);
                EXPECT_NEAR(layers.beauty.at(x, y, c), composited, 1e-5);
            }
            covered += layers.alpha.at(x, y) > 0;
        }
    }
    EXPECT_GT(covered, 500);
    EXPECT_LT(*std::ranges::min_element(layers.shadow.samples()), 0.9) << "it casts its shadow on the table";
}

TEST_F(LampScene, WhatIsVirtualFadesWithItsDistance) {
    Shot shot = make_shot();
    shot.scene.effects.depth_cue = DepthCueSettings{.near_m = 0, .far_m = 1e-3, .color = {0, 0.5, 0}};
    const CompositedFrame frame = with_layers(shot);
    const FrameLayers& layers = *frame.layers;
    int seen = 0;
    for (int y = 0; y < layers.region.height; ++y) {
        for (int x = 0; x < layers.region.width; ++x) {
            if (layers.alpha.at(x, y) < 1) continue;
            EXPECT_EQ(layers.virtual_rgba.at(x, y, 0), 0);
            EXPECT_GT(layers.virtual_rgba.at(x, y, 1), 0);
            ++seen;
        }
    }
    EXPECT_GT(seen, 200);
    // Lines, too.
    shot.scene.objects[0].material.shading = {
        .model = ShadingModel::cartoon, .outline_px = 3, .outline_color = {1, 0, 0}};
    const CompositedFrame outlined = with_layers(shot);
    for (int y = 0; y < outlined.layers->region.height; ++y) {
        for (int x = 0; x < outlined.layers->region.width; ++x) EXPECT_EQ(outlined.layers->virtual_rgba.at(x, y, 0), 0);
    }
    // Of no strength it is the identity, and drawn in no program.
    Shot without = make_shot(), none = make_shot();
    none.scene.effects.depth_cue = DepthCueSettings{.strength = 0};
    for (const bool leave_out : {true, false}) {
        EXPECT_TRUE(std::ranges::equal(composite(none, leave_out).rgb16().samples(),
                                       composite(without, true).rgb16().samples()));
    }
}

TEST(ProbeLamps, AreItsBrightPartsOrTheSideThatIsBrighter) {
    const Eigen::Vector3d lamp = Eigen::Vector3d(1, 0, 2).normalized();
    Probe probe{ImageF(128, 64, 3)};
    const auto fill = [&](const auto& radiance) {
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 128; ++x) {
                const auto value = static_cast<float>(radiance(latlong_direction(x, y, 128, 64)));
                for (int c = 0; c < 3; ++c) probe.latlong.at(x, y, c) = value;
            }
        }
    };
    fill([&](const Eigen::Vector3d& d) { return d.dot(lamp) > 0.98 ? 50.0 : 0.5; });
    const std::vector<LampSettings> one = lamps_of_probe(probe);
    ASSERT_EQ(one.size(), 1U);
    EXPECT_LT((-one[0].direction - lamp).norm(), 0.05);
    constexpr double solid_angle = 2 * std::numbers::pi * 0.02;
    EXPECT_NEAR(one[0].color.x(), 50 * solid_angle, 0.1 * 50 * solid_angle) << "pixels are 3 degrees wide";
    EXPECT_TRUE(one[0].of_probe);
    fill([&](const Eigen::Vector3d& d) { return 1 + 0.5 * d.z(); });
    const std::vector<LampSettings> sky = lamps_of_probe(probe);
    ASSERT_EQ(sky.size(), 1U);
    EXPECT_LT((-sky[0].direction - Eigen::Vector3d::UnitZ()).norm(), 0.01);
    fill([](const Eigen::Vector3d&) { return 1.0; });
    EXPECT_TRUE(lamps_of_probe(probe).empty());
}

}  // namespace
}  // namespace matchlight::test
