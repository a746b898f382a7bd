// Objects mirrored in a shiny table, against rays in double precision: a mirror, rough tables, and nothing at all.
#include "render/effects/surface_reflection.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "compositor/lens_map.h"
#include "compositor_shot.h"
#include "report/near_light_reference.h"
#include "scene/ray_caster.h"

namespace matchlight::test {
namespace {

/// What every direction sends without a probe.
constexpr double even_light = 0.5;
constexpr double lamp_light = 64;

class SurfaceReflectionTest : public CompositorTest {
protected:
    /// A box that glows, above a table in even light that catches no shadow: then the plate's own light stays.
    static Shot lamp_over_table(double reflection, double roughness) {
        Shot shot = make_shot();
        shot.scene.quality = QualityLevel::final_;
        shot.scene.probe.reset();
        shot.scene.surface.shadow = false;
        shot.scene.surface.reflection = reflection;
        shot.scene.surface.reflection_roughness = roughness;
        ObjectSettings lamp;
        lamp.shape = "box";
        lamp.name = "lamp";
        lamp.scale = lamp_size_m;
        lamp.translate_m = lamp_place_m;
        lamp.material.base_color = {0, 0, 0};
        lamp.material.metallic = 0;
        lamp.material.roughness = 1;
        lamp.material.emissive = {lamp_light, lamp_light, lamp_light};
        shot.scene.objects = {lamp};
        return shot;
    }

    CompositedFrame render(const Shot& shot, int surface_rays, bool leave_out = true) {
        Warnings warnings;
        warnings.set_quiet(true);
        // The rest as cheap as a level has it.
        Quality quality = quality_of(QualityLevel::preview);
        if (shot.scene.quality == QualityLevel::final_)
            quality.reflection = {.level = ReflectionLevel::rays, .surface_rays = surface_rays};
        Compositor compositor(context(), shot.scene, shot.solve,
                              {.settings = quality, .layers = true, .leave_out = leave_out}, warnings);
        CompositedFrame frame = compositor.composite(grey_plate(320, 180, plate_luma_));
        reports_ = compositor.reports();
        return frame;
    }

    /// The lamp in double precision.
    static RayCaster lamp_caster() {
        std::vector<Eigen::Vector3d> corners;
        for (int i = 0; i < 8; ++i) {
            const Eigen::Vector3d side((i & 1) - 0.5, ((i >> 1) & 1) - 0.5, ((i >> 2) & 1) - 0.5);
            corners.push_back(lamp_place_m + side.cwiseProduct(lamp_size_m));
        }
        const std::vector<std::uint32_t> triangles{0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                                   2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 3, 7, 1, 7, 5};
        RayCaster caster;
        caster.add_mesh(corners, triangles);
        caster.build();
        return caster;
    }

    struct TablePoint {
        Eigen::Vector3d at_m, towards_eye;
    };
    static TablePoint table_at(const Shot& shot, const LensMap& lens_map, double x, double y) {
        const RigidTransform world_from_camera = shot.solve.frames.front().camera_from_world->inverse();
        const Eigen::Vector3d eye = world_from_camera.translation();
        const Eigen::Vector3d direction = world_from_camera.linear() * lens_map.normalized(x, y).homogeneous();
        return {eye - eye.z() / direction.z() * direction, -direction.normalized()};
    }

    static inline const Eigen::Vector3d lamp_size_m{0.06, 0.04, 0.05}, lamp_place_m{0.02, 0.03, 0.06};
};

float at(const ImageF& image, const Region& region, int x, int y) {
    return image.at(x - region.x, y - region.y, 0);
}

TEST_F(SurfaceReflectionTest, AMirrorShowsTheMirroredBoxInTheTablesPlace) {
    const Shot shot = lamp_over_table(1, 0);
    constexpr int rays = 64;
    const CompositedFrame frame = render(shot, rays);
    ASSERT_TRUE(frame.layers);
    const FrameLayers& layers = *frame.layers;
    const RayCaster caster = lamp_caster();
    const LensMap lens_map = make_lens_map(shot.solve.camera);
    const double gain = 0.5;
    double largest_inside = 0, difference = 0;
    int inside = 0, edges = 0, outside = 0;
    for (int y = layers.region.y; y < layers.region.y + layers.region.height; ++y) {
        for (int x = layers.region.x; x < layers.region.x + layers.region.width; ++x) {
            if (at(layers.alpha, layers.region, x, y) > 0) continue;
            constexpr int across = 8;
            int hits = 0;
            for (int i = 0; i < across * across; ++i) {
                const int column = i % across, row = i / across;
                const TablePoint point =
                    table_at(shot, lens_map, x + (column + 0.5) / across - 0.5, y + (row + 0.5) / across - 0.5);
                Eigen::Vector3d mirrored = -point.towards_eye;
                mirrored.z() = -mirrored.z();
                hits += caster.nearest(point.at_m, mirrored, 0) ? 1 : 0;
            }
            const double coverage = static_cast<double>(hits) / (across * across);
            const double plate = at(layers.plate, layers.region, x, y);
            // The plate is darker than what it is said to mirror: it goes where the box is.
            ASSERT_LT(plate, even_light * gain);
            const double expected = coverage * (lamp_light * gain - plate);
            const double found = at(layers.reflection, layers.region, x, y);
            if (hits == 0) {
                // A ray within the pixel may lie between those looked at here.
                EXPECT_LT(found, 0.1 * lamp_light * gain) << x << ' ' << y;
                ++outside;
            } else if (hits == across * across) {
                largest_inside = std::max(largest_inside, std::abs(found / expected - 1));
                ++inside;
            } else {
                difference += std::abs(found - expected) / (lamp_light * gain);
                ++edges;
            }
        }
    }
    EXPECT_GT(inside, 200);
    EXPECT_GT(edges, 50);
    EXPECT_GT(outside, 1000);
    // One of the rays may pass beside a corner.
    EXPECT_LT(largest_inside, 1.2 / rays);
    // 64 rays over a pixel (two of the four dimensions that they fill evenly) put an edge within some hundredths of it.
    EXPECT_LT(difference / edges, 0.04);
}

TEST_F(SurfaceReflectionTest, ARoughTableShowsWhatItsLobeSees) {
    const RayCaster caster = lamp_caster();
    for (const double roughness : {0.1, 0.3, 1.0}) {
        for (const double reflection : {1.0, 0.04}) {
            const Shot shot = lamp_over_table(reflection, roughness);
            const CompositedFrame frame = render(shot, 64);
            ASSERT_TRUE(frame.layers);
            const FrameLayers& layers = *frame.layers;
            const LensMap lens_map = make_lens_map(shot.solve.camera);
            double expected = 0, found = 0;
            int pixels = 0;
            for (int y = 100; y < 160; y += 4) {
                for (int x = 140; x < 200; x += 4) {
                    // The mean of a block against its middle.
                    double alpha = 0, in_block = 0;
                    for (int i = 0; i < 16; ++i) {
                        const int column = i % 4, row = i / 4;
                        alpha += at(layers.alpha, layers.region, x + column, y + row);
                        in_block += at(layers.reflection, layers.region, x + column, y + row) / 16;
                    }
                    if (alpha > 0) continue;
                    const TablePoint point = table_at(shot, lens_map, x + 1.5, y + 1.5);
                    const LobeView lobe{
                        .towards_eye = point.towards_eye, .roughness = roughness, .reflectance = reflection};
                    const auto light = [&](double of_lamp, double of_rest) {
                        return reference_mirrored(lobe, 48,
                                                  [&](const Eigen::Vector3d& along) -> Eigen::Vector3d {
                                                      const bool hits =
                                                          caster.nearest(point.at_m, along, 0).has_value();
                                                      return Eigen::Vector3d::Constant(hits ? of_lamp : of_rest);
                                                  })
                            .x();
                    };
                    const double plate = at(layers.plate, layers.region, x, y), gain = 0.5;
                    const double all = gain * light(even_light, even_light);
                    expected += gain * light(lamp_light, 0) - std::min(1.0, plate / all) * gain * light(even_light, 0);
                    found += in_block;
                    ++pixels;
                }
            }
            ASSERT_GT(pixels, 20);
            ASSERT_GT(expected, 0);
            // Lobes are cut where a hundredth of them is left, each ray stands for a 64th of their variance, and the
            // table of split sums ends half a texel before roughness 1. Schlick's curve is taken out of the lobe's
            // integral: 1 is 1 everywhere, and 0.04 grows towards the horizon, where rough lobes look.
            EXPECT_NEAR(found / expected, 1, reflection == 1 ? 0.04 : 0.1) << roughness << ' ' << reflection;
        }
    }
}

TEST_F(SurfaceReflectionTest, AWhiteBallInEvenLightChangesNothing) {
    Shot shot = make_shot();
    shot.scene.quality = QualityLevel::final_;
    shot.scene.probe.reset();
    shot.scene.surface.shadow = false;
    shot.scene.surface.reflection = 1;
    shot.scene.objects[0].material.roughness = 0;
    // The table, too, sends what all else does.
    const CompositedFrame before = render(shot, 4);
    const double plate = before.layers->plate.at(0, 0, 0);
    shot.solve.frames.front().exposure_ev = std::log2(plate / even_light);
    for (const double roughness : {0.0, 0.3, 1.0}) {
        shot.scene.surface.reflection_roughness = roughness;
        const CompositedFrame frame = render(shot, 16);
        double largest = 0;
        for (const float light : frame.layers->reflection.samples())
            largest = std::max<double>(largest, std::abs(light));
        EXPECT_LT(largest, 0.005 * plate) << roughness;
    }
}

TEST_F(SurfaceReflectionTest, NothingIsTakenBelowZero) {
    // A black box before a bright probe, over a plate that is nearly black.
    Shot shot = lamp_over_table(1, 0.2);
    shot.scene.objects[0].material.emissive = {0, 0, 0};
    shot.solve.frames.front().exposure_ev = 0;
    plate_luma_ = 60;
    const CompositedFrame frame = render(shot, 8);
    const auto [least, most] = std::ranges::minmax(frame.layers->reflection.samples());
    EXPECT_LT(least, -1e-3F) << "it covers what the plate shows";
    EXPECT_GE(std::ranges::min(frame.layers->beauty.samples()), 0);
    EXPECT_LT(most, 1e-3F) << "a black box sends less than what it covers";
}

TEST_F(SurfaceReflectionTest, PixelsThatMirrorNothingStayThePlates) {
    const Shot shot = lamp_over_table(0.5, 0.05);
    const CompositedFrame frame = render(shot, 8);
    const FrameLayers& layers = *frame.layers;
    const Image16 picture = frame.rgb16(), plate = grey_plate(320, 180, plate_luma_).rgb16({0, 0, 320, 180});
    int mirrors = 0, untouched = 0;
    for (int y = 0; y < 180; ++y) {
        for (int x = 0; x < 320; ++x) {
            const bool in_layers = layers.region.contains(x, y);
            const bool is_mirrored = in_layers && at(layers.reflection, layers.region, x, y) != 0;
            const bool is_object = in_layers && at(layers.alpha, layers.region, x, y) > 0;
            if (is_mirrored || is_object) {
                mirrors += is_mirrored ? 1 : 0;
                continue;
            }
            ASSERT_TRUE(std::equal(picture.pixel(x, y), picture.pixel(x, y) + 3, plate.pixel(x, y))) << x << ' ' << y;
            ++untouched;
        }
    }
    EXPECT_GT(mirrors, 500);
    EXPECT_GT(untouched, 320 * 180 / 2);
}

TEST_F(SurfaceReflectionTest, LeavingOutWhatIsNotNeededChangesNoBit) {
    for (const double reflection : {0.0, 0.6}) {
        Shot shot = lamp_over_table(reflection, 0.15);
        shot.scene.surface.shadow = true;
        const CompositedFrame lean = render(shot, 4, true);
        EXPECT_EQ(was_drawn("surface reflection"), reflection > 0);
        const CompositedFrame whole = render(shot, 4, false);
        EXPECT_TRUE(was_drawn("surface reflection"));
        EXPECT_TRUE(std::ranges::equal(lean.rgb16().samples(), whole.rgb16().samples())) << reflection;
    }
}

TEST_F(SurfaceReflectionTest, LevelsWithoutRaysSayThatTheyDoWithout) {
    Shot shot = lamp_over_table(0.5, 0.1);
    shot.scene.quality = QualityLevel::preview;
    const CompositedFrame frame = render(shot, 4);
    EXPECT_TRUE(frame.layers->reflection.empty());
    const auto found = std::ranges::find(reports_, "surface reflection", &PassReport::name);
    ASSERT_NE(found, reports_.end());
    EXPECT_EQ(found->why, "this quality level traces no rays");
}

TEST_F(SurfaceReflectionTest, WhatARealThingHidesIsNotMirrored) {
    Shot shot = lamp_over_table(1, 0);
    const auto mirrored_light = [&] {
        const CompositedFrame frame = render(shot, 4);
        double sum = 0;
        for (const float light : frame.layers->reflection.samples()) sum += std::abs(light);
        return sum;
    };
    const double open = mirrored_light();
    // A real sheet between the lamp and the table.
    ObjectSettings sheet;
    sheet.shape = "box";
    sheet.name = "sheet";
    sheet.scale = {0.2, 0.2, 0.002};
    sheet.translate_m = {0.02, 0.03, 0.02};
    sheet.holdout = true;
    shot.scene.objects.push_back(sheet);
    EXPECT_GT(open, 100);
    EXPECT_LT(mirrored_light(), 0.2 * open);
}

}  // namespace
}  // namespace matchlight::test
