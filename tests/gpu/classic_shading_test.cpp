// Classic shading against the double-precision reference, its outlines, and depth cueing.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "gl_fixture.h"
#include "render/environment.h"
#include "render/lamps.h"
#include "render/surface.h"
#include "render_scene.h"
#include "report/classic_reference.h"

namespace matchlight::test {
namespace {

constexpr double pi = std::numbers::pi;

class ClassicShadingTest : public GlTest {
protected:
    const TestCamera camera_{.eye = {0, -3, 0}, .forward = {0, 1, 0}, .right = {1, 0, 0}};

    static std::vector<LampSettings> two_suns() {
        return {{.type = LampType::directional, .intensity = 3, .direction = {0.5, 1, -0.7}, .casts_shadow = false},
                {.type = LampType::directional,
                 .color = {0.2, 0.4, 1},
                 .intensity = 2,
                 .direction = {-1, 0.3, 0.2},
                 .casts_shadow = false}};
    }
    SurfaceObject ball(const ClassicShading& shading) {
        SurfaceObject object{.model = &sphere_};
        object.material.diffuse = {0.8, 0.4, 0.2};
        object.material.specular = {0.5, 0.5, 0.5};
        object.material.shading = shading;
        return object;
    }
    ImageF draw(const SurfaceObject& object, const std::vector<LampSettings>& settings, double light = 0,
                const std::function<void(SurfaceShading&)>& change = {}) {
        SurfaceRenderer surfaces(shaders_);
        surfaces.add_object(object);
        const Environment environment(shaders_, uniform_probe(light));
        const Lamps lamps(settings);
        std::function<void(Program&)> more;
        SurfaceShading shading;
        shading.has_lamps = true;
        if (change) change(shading);
        shading.bind = [&lamps, more = shading.bind](Program& program) {
            lamps.bind(program);
            if (more) more(program);
        };
        const SurfaceView view = camera_.view(1);
        return surfaces.draw(environment, view, shading).color->read<float>({0, 0, view.width, view.height}, 4);
    }

    ShaderLibrary shaders_;
    const Model sphere_ = make_sphere(0.9);
};

TEST_F(ClassicShadingTest, EveryModelIsItsReference) {
    constexpr double ambient = 0.3;
    const std::vector<LampSettings> suns = two_suns();
    std::vector<ClassicLamp> lamps;
    for (const LampSettings& sun : suns) lamps.push_back({-sun.direction.normalized(), sun.intensity * sun.color});
    for (const ShadingModel model :
         {ShadingModel::phong, ShadingModel::blinn_phong, ShadingModel::cartoon, ShadingModel::gooch}) {
        const ClassicShading shading{.model = model, .shininess = 20, .tones = 4};
        const ImageF drawn = draw(ball(shading), suns, ambient);
        int seen = 0, differing = 0;
        for (int y = 0; y < drawn.height(); y += 2) {
            for (int x = 0; x < drawn.width(); x += 2) {
                const Eigen::Vector3d ray = camera_.ray(x, y);
                const auto hit = hit_sphere(camera_.eye, ray, 0.9);
                if (!hit || -hit->normalized().dot(ray) < 0.1) continue;  // a pixel at the rim is covered in part
                const Eigen::Vector3d expected = classic_reference(shading,
                                                                   {.normal = hit->normalized(),
                                                                    .to_eye = -ray,
                                                                    .diffuse = {0.8, 0.4, 0.2},
                                                                    .specular = {0.5, 0.5, 0.5},
                                                                    .ambient = Eigen::Vector3d::Constant(ambient)},
                                                                   lamps);
                ++seen;
                // Half floats, and normals between a mesh's: within half a code of 255 at white.
                for (int c = 0; c < 3; ++c) {
                    if (std::abs(drawn.at(x, y, c) - expected[c]) > 0.002 + 0.003 * expected[c]) {
                        ++differing;
                        break;
                    }
                }
            }
        }
        EXPECT_GT(seen, 1000);
        // On the border of a tone a rounding decides.
        EXPECT_LE(differing, model == ShadingModel::cartoon || model == ShadingModel::gooch ? seen / 50 : 0)
            << static_cast<int>(model);
    }
}

TEST_F(ClassicShadingTest, WhatALampTakesOfTheProbeIsNotAmbientTwice) {
    // A probe's irradiance to order 2 holds all of a lamp that stands for a part of it.
    std::vector<LampSettings> suns = two_suns();
    suns.pop_back();
    suns[0].of_probe = true;
    suns[0].intensity = 0.2;
    const ImageF drawn = draw(ball({.model = ShadingModel::phong, .shininess = 1e4}), suns, 0.3);
    const Eigen::Vector3d to_lamp = -suns[0].direction.normalized();
    for (const auto& [x, y] : {std::pair{64, 64}, {80, 50}, {50, 70}}) {
        const Eigen::Vector3d n = hit_sphere(camera_.eye, camera_.ray(x, y), 0.9)->normalized();
        const double cosine = n.dot(to_lamp);
        const double smooth = 0.25 + cosine / 2 + 5.0 / 32 * (3 * cosine * cosine - 1);
        const double expected = 0.8 * (0.3 + 0.2 / pi * (std::max(cosine, 0.0) - smooth));
        EXPECT_NEAR(drawn.at(x, y, 0), expected, 0.002) << x << " " << y;
    }
}

TEST_F(ClassicShadingTest, OneToneIsFlat) {
    const ImageF drawn = draw(ball({.model = ShadingModel::cartoon, .shininess = 1e4, .tones = 1}), {two_suns()[0]});
    EXPECT_EQ(drawn.at(64, 64, 0), drawn.at(80, 64, 0));
    EXPECT_EQ(drawn.at(64, 64, 0), drawn.at(64, 50, 0));
}

TEST_F(ClassicShadingTest, OutlinesLieInsideTheSilhouetteAsWideAsAsked) {
    SurfaceObject object = ball({.model = ShadingModel::cartoon, .tones = 1});
    const ImageF plain = draw(object, two_suns());
    object.material.shading.outline_px = 3;
    object.material.shading.outline_color = {0, 0, 7};
    const ImageF lined = draw(object, two_suns());
    const int y = 64;
    int first = 0;
    while (plain.at(first, y, 3) == 0) ++first;
    int line = first;
    while (lined.at(line, y, 2) > 6.9F) ++line;
    EXPECT_NEAR(line - first, 3, 1) << "with half a pixel's blur at its inner side";
    EXPECT_EQ(lined.at(64, 64, 2), plain.at(64, 64, 2)) << "a smooth ball has no edge within";
    for (int x = 0; x < plain.width(); ++x) EXPECT_EQ(lined.at(x, y, 3), plain.at(x, y, 3)) << "coverage stays";
}

TEST_F(ClassicShadingTest, OutlinesFollowCreases) {
    Model box = make_square(1);
    // Two squares that meet at a right angle, a vertical edge towards the camera.
    ModelMesh& mesh = box.meshes[0];
    const ModelMesh flat = mesh;
    mesh.vertices.clear();
    mesh.indices.clear();
    for (const float side : {-1.F, 1.F}) {
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (ModelVertex vertex : flat.vertices) {
            const float along = vertex.position[0] + 0.5F, up = vertex.position[1];
            vertex.position = {side * along * 0.7F, along * 0.7F, up};
            vertex.normal = {side * 0.7071F, -0.7071F, 0};
            vertex.tangent = {0, 0, 1, 1};
            mesh.vertices.push_back(vertex);
        }
        for (const std::uint32_t index : flat.indices) mesh.indices.push_back(first + index);
    }
    box.materials[0].double_sided = true;
    SurfaceObject object{.model = &box};
    object.material.shading = {.model = ShadingModel::gooch, .outline_px = 2, .outline_color = {0, 9, 0}};
    const ImageF drawn = draw(object, two_suns());
    EXPECT_GT(drawn.at(64, 64, 1), 8) << "the edge in the middle";
    EXPECT_LT(drawn.at(76, 64, 1), 5) << "the faces beside it";
    EXPECT_LT(drawn.at(52, 64, 1), 5);
}

TEST_F(ClassicShadingTest, DepthCueingIsItsReference) {
    const Eigen::Vector3d fog(0.1, 0.2, 0.3);
    constexpr double near_m = 2.2, far_m = 2.8, strength = 0.75;
    const SurfaceObject object = ball({.model = ShadingModel::phong});
    const ImageF plain = draw(object, two_suns());
    const ImageF faded = draw(object, two_suns(), 0, [&](SurfaceShading& shading) {
        shading.fades_with_depth = true;
        shading.bind = [&](Program& program) {
            program.set("depth_cue_color", Eigen::Vector3f(fog.cast<float>()));
            program.set("depth_cue_range_m", Eigen::Vector2f(near_m, far_m));
            program.set("depth_cue_strength", strength);
        };
    });
    for (const auto& [x, y] : {std::pair{64, 64}, {84, 50}, {40, 70}, {64, 100}}) {
        const double z_m = hit_sphere(camera_.eye, camera_.ray(x, y), 0.9)->y() + 3;
        const double share = strength * std::clamp((z_m - near_m) / (far_m - near_m), 0.0, 1.0);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(faded.at(x, y, c), (1 - share) * plain.at(x, y, c) + share * fog[c], 0.002) << x << " " << y;
    }
}

}  // namespace
}  // namespace matchlight::test
