// How a lens focuses what surfaces show: mirrors at their virtual image, transparent meshes apart, objects on their
// own.
#include <cmath>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>

#include "gl_fixture.h"
#include "render/surface.h"
#include "render/virtual_layer.h"
#include "render_scene.h"

namespace matchlight {
namespace {

using test::make_sphere;
using test::make_square;
using test::metal;
using test::TestCamera;
using test::uniform_probe;

constexpr double distance_m = 4, sphere_radius_m = 1;

class LensFocus : public GlTest {
protected:
    /// Before the camera, which stands at the origin and looks along y.
    void add(Model model, const ModelMaterial& material, double y_m = distance_m) {
        model.materials[0] = material;
        Eigen::Matrix4d world_from_model = Eigen::Matrix4d::Identity();
        // A square's front, which faces +z, towards the camera.
        world_from_model.topLeftCorner<3, 3>() =
            Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
        world_from_model(1, 3) = y_m;
        renderer_->add_object({.model = &model, .world_from_model = world_from_model});
    }
    SurfaceView view(const Focus& focus) const {
        SurfaceView view = camera_.view(1);
        const double diameter_m = focus.coc_scale_px_m / camera_.focal_px;
        view.lens = SurfaceLens{.focus = focus,
                                .range = {.nearest_px = -1e3, .farthest_px = 1e3},
                                .right_world_m = diameter_m * Eigen::Vector3d::UnitX(),
                                .down_world_m = -diameter_m * Eigen::Vector3d::UnitZ()};
        return view;
    }
    /// Depth that has the circle of what the picture's middle shows.
    double focused_depth_m(const SurfacePicture& picture) const { return near_plane_m / middle(*picture.focus_share); }
    float middle(const Texture2D& texture, int channel = 0) const {
        const int channels = texture.shape().format == GL_R32F ? 1 : 4;
        return texture.read<float>({camera_.size / 2, camera_.size / 2, 1, 1}, channels).at(0, 0, channel);
    }
    SurfacePicture draw(const SurfaceView& view) { return renderer_->draw(environment_, view); }

    TestCamera camera_{.eye = Eigen::Vector3d::Zero(),
                       .forward = Eigen::Vector3d::UnitY(),
                       .right = Eigen::Vector3d::UnitX(),
                       .focal_px = 4000};
    ShaderLibrary shaders_;
    std::optional<SurfaceRenderer> renderer_{std::in_place, shaders_};
    Environment environment_{shaders_, uniform_probe(1)};
};

constexpr double front_m = distance_m - sphere_radius_m;

TEST_F(LensFocus, AMirrorBallShowsItsVirtualImageHalfARadiusBehindItsSurface) {
    add(make_sphere(sphere_radius_m, 256), metal(0));
    // Before the ball, so that the image blurs more than the surface; and behind the image, so that it blurs less.
    for (const double focus_m : {2.0, 6.0, 1e6}) {
        SurfaceView seen = view({.coc_scale_px_m = 200, .focus_distance_m = focus_m});
        const double image_m = front_m + sphere_radius_m / 2;
        EXPECT_NEAR(focused_depth_m(draw(seen)) / image_m, 1, 0.01) << focus_m;
        seen.lens->focuses_reflections = false;
        EXPECT_NEAR(focused_depth_m(draw(seen)) / front_m, 1, 1e-4) << focus_m;
    }
}

TEST_F(LensFocus, ARoughOrPaintedBallIsWhereItsSurfaceIs) {
    ModelMaterial paint;
    paint.roughness = 1;
    for (const ModelMaterial& material : {metal(1), paint}) {
        renderer_.emplace(shaders_);
        add(make_sphere(sphere_radius_m, 64), material);
        const SurfaceView seen = view({.coc_scale_px_m = 200, .focus_distance_m = 2});
        EXPECT_NEAR(focused_depth_m(draw(seen)) / front_m, 1, 0.01);
    }
}

TEST_F(LensFocus, AFlatMirrorKeepsItsEdgesAndSpreadsItsLight) {
    // In focus itself, it reflects from infinity two halves: their border is as wide as the circle of what is far away.
    const Focus focus{.coc_scale_px_m = 200, .focus_distance_m = distance_m};
    const Eigen::Vector3d into_light(1, 0, 0);
    const Environment halves(shaders_, test::make_probe(2048, [&](const Eigen::Vector3d& direction) -> Eigen::Vector3d {
                                 return Eigen::Vector3d::Constant(direction.dot(into_light) > 0 ? 1.0 : 0.0);
                             }));
    camera_.focal_px = 800;
    add(make_square(1), metal(0));
    SurfaceView seen = view(focus);
    const auto width_px = [&] {
        const SurfacePicture picture = renderer_->draw(halves, seen);
        EXPECT_NEAR(focused_depth_m(picture) / distance_m, 1, 1e-4);
        const ImageF row = picture.color->read<float>({0, camera_.size / 2, camera_.size, 1}, 4);
        int between = 0;
        for (int x = 0; x < camera_.size; ++x) between += row.at(x, 0, 0) > 0.1 && row.at(x, 0, 0) < 0.9 ? 1 : 0;
        return between;
    };
    const double circle_px = signed_coc_px(focus, 1e9);
    // A disc's edge rises from a tenth to nine tenths over 0.687 of its diameter.
    EXPECT_NEAR(width_px(), 0.687 * circle_px, 0.1 * circle_px);
    seen.lens->focuses_reflections = false;
    EXPECT_LT(width_px(), 0.2 * circle_px);
}

TEST_F(LensFocus, AnObjectMayHaveAFocusOfItsOwn) {
    ModelMaterial paint;
    paint.roughness = 1;
    add(make_square(1), paint);
    const Focus focus{.coc_scale_px_m = 200, .focus_distance_m = 2};
    const double own_m = 3;
    const ObjectFocus own{0, own_m}, sharp{0, std::nullopt};
    SurfaceView seen = view(focus);
    seen.lens->apart = std::span(&own, 1);
    const auto circle_px = [&] { return signed_coc_px(focus, focused_depth_m(draw(seen))); };
    EXPECT_NEAR(circle_px(), signed_coc_px({focus.coc_scale_px_m, own_m}, distance_m), 1e-3);
    seen.lens->apart = std::span(&sharp, 1);
    EXPECT_NEAR(circle_px(), 0, 1e-4);
}

TEST_F(LensFocus, WhatLetsLightThroughIsDrawnApart) {
    ModelMaterial wall, glass;
    wall.roughness = glass.roughness = 1;
    glass.alpha_mode = AlphaMode::blend;
    glass.base_color = {1, 1, 1, 0.25};
    add(make_square(1), wall);
    add(make_square(1), glass, 2);
    SurfaceView seen = view({.coc_scale_px_m = 200, .focus_distance_m = 3});
    const SurfacePicture both = draw(seen);
    EXPECT_NEAR(focused_depth_m(both) / distance_m, 1, 1e-4);
    const float light_of_both = middle(*both.color);
    seen.lens->parts_transparent = true;
    const SurfacePicture behind = draw(seen);
    const float light_behind = middle(*behind.color);
    EXPECT_NEAR(focused_depth_m(behind) / distance_m, 1, 1e-4);
    const SurfacePicture before = renderer_->draw_transparent(environment_, seen);
    const float coverage = middle(*before.color, 3);
    EXPECT_NEAR(coverage, 0.25, 1e-3);
    EXPECT_NEAR(near_plane_m * coverage / middle(*before.focus_share) / 2, 1, 1e-4);
    EXPECT_NEAR(middle(*before.color) + (1 - coverage) * light_behind, light_of_both, 2e-3);
    // Not through what is before it.
    ModelMaterial nearest = wall;
    add(make_square(1), nearest, 1);
    draw(seen);
    EXPECT_EQ(middle(*renderer_->draw_transparent(environment_, seen).color, 3), 0);
}

}  // namespace
}  // namespace matchlight
