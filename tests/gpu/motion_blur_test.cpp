// Motion blur in whole frames: trails of known shape, what belongs together, and what is left out.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "compositor/compositor.h"
#include "gl_fixture.h"
#include "grey_plate.h"

namespace matchlight {
namespace {

constexpr int width = 128, height = 64;
constexpr double focal_px = 100, height_m = 1;

/// A camera that looks straight down from a metre's height: a plate pixel is a centimetre of the world's plane.
class MotionBlur : public GlTest {
protected:
    void SetUp() override {
        GlTest::SetUp();
        warnings_.set_quiet(true);
        solve_.footage_file = "clip";
        solve_.camera.width = width;
        solve_.camera.height = height;
        solve_.camera.fx = solve_.camera.fy = focal_px;
        solve_.camera.cx = (width - 1) / 2.0;
        solve_.camera.cy = (height - 1) / 2.0;
        scene_.surface.present = false;
        ObjectSettings square;
        square.shape = "plane";
        square.name = "square";
        square.material.emissive = {1, 1, 1};
        scene_.objects = {square};
        set_square_px(8);
        move_camera_px({0, 0});
    }

    void set_square_px(double side_px) {
        const double side_m = side_px / focal_px * height_m;
        // Shapes are a metre wide.
        scene_.objects[0].scale = {side_m, side_m, 1};
    }
    /// Three frames; what lies on the plane moves over the picture by so many pixels a frame.
    void move_camera_px(const Eigen::Vector2d& px_a_frame) {
        solve_.frames.clear();
        for (int i = 0; i < 3; ++i) {
            SolvedFrame frame;
            frame.frame = i;
            frame.time_s = i / 25.0;
            // Down in the picture is −y in the world.
            const Eigen::Vector3d eye((1 - i) * px_a_frame.x() / focal_px, (i - 1) * px_a_frame.y() / focal_px,
                                      height_m);
            frame.camera_from_world = camera_looking_along(eye, -Eigen::Vector3d::UnitZ());
            frame.exposure_ev = 0;
            solve_.frames.push_back(frame);
        }
        solve_.frame_count = 3;
    }
    static CompositorOptions options(CompositorOptions with = {}) {
        with.settings = without_rays(Quality{.supersampling = 4,
                                             .mirror_face_px = 16,
                                             .shadow = {.directions = 16, .resolution = 256},
                                             .object_shadow = {.directions = 0}});
        return with;
    }
    CompositedFrame composite(bool leave_out = true, bool layers = true) {
        Compositor compositor(context(), scene_, solve_, options({.layers = layers, .leave_out = leave_out}),
                              warnings_);
        CompositedFrame frame = compositor.composite(test::grey_plate(width, height, 120, 1));
        reports_ = compositor.reports();
        return frame;
    }
    /// A layer over the whole frame, `elsewhere` outside of what was drawn.
    static ImageF whole(const CompositedFrame& frame, const ImageF& layer, float elsewhere = 0) {
        ImageF image(width, height, layer.channels(), elsewhere);
        const Region& region = frame.layers->region;
        for (int y = 0; y < region.height; ++y) {
            for (int x = 0; x < region.width; ++x) {
                std::copy_n(layer.pixel(x, y), layer.channels(), image.pixel(region.x + x, region.y + y));
            }
        }
        return image;
    }
    ImageF alpha(const MotionBlurSettings& settings) {
        scene_.effects.motion_blur = settings;
        const CompositedFrame frame = composite();
        return whole(frame, frame.layers->alpha);
    }
    bool was_drawn(const std::string& pass) const {
        return std::ranges::any_of(reports_,
                                   [&](const PassReport& report) { return report.name == pass && report.drawn; });
    }

    Warnings warnings_;
    Scene scene_;
    Solve solve_;
    std::vector<PassReport> reports_;
};

double overlap(double low, double high, double other_low, double other_high) {
    return std::max(0.0, std::min(high, other_high) - std::max(low, other_low));
}

/// Coverage at distance `x` from the middle: of a pixel, by something `side` wide on a way of `way`, all in pixels.
double trail(double x, double side, double way) {
    constexpr int steps = 400;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double at = x + (i + 0.5) / steps - 0.5;
        sum += way > 0 ? overlap(at - way / 2, at + way / 2, -side / 2, side / 2) / way : std::abs(at) < side / 2;
    }
    return sum / steps;
}

constexpr MotionBlurSettings gathered{.shutter = 0.5};
constexpr MotionBlurSettings at_many_times{.level = MotionBlurLevel::sub_frames, .shutter = 0.5, .sub_frames = 64};

TEST_F(MotionBlur, ATrailIsABoxAsLongAsTheWay) {
    for (const double side_px : {1.0, 8.0, 30.0}) {
        set_square_px(side_px);
        move_camera_px({40, 0});  // 20 pixels in half the frame's time
        for (const MotionBlurSettings& settings : {gathered, at_many_times}) {
            const ImageF seen = alpha(settings);
            // 64 times are steps of a third of a pixel, and the layer has four pixels to a plate pixel.
            double worst = 0;
            for (int y : {31, 32}) {
                const double rows = trail(y - 31.5, side_px, 0);
                for (int x = 0; x < width; ++x) {
                    worst = std::max(worst, std::abs(seen.at(x, y, 0) - rows * trail(x - 63.5, side_px, 20)));
                }
            }
            EXPECT_LT(worst, 0.02) << side_px << " at level " << static_cast<int>(settings.level);
        }
    }
}

TEST_F(MotionBlur, NoLightIsLostInAnyDirection) {
    const CompositedFrame sharp = composite();
    const auto sum_of = [](const ImageF& image) {
        double sum = 0;
        for (const float value : image.samples()) sum += value;
        return sum;
    };
    const double expected = sum_of(sharp.layers->alpha);
    EXPECT_NEAR(expected, 64, 1e-3);
    for (const Eigen::Vector2d& way : {Eigen::Vector2d(40, 0), {0, -30}, {21, 33}, {-5, 1}, {0.9, 0.9}}) {
        move_camera_px(way);
        EXPECT_NEAR(sum_of(alpha(gathered)), expected, 1e-3 * expected) << way.transpose();
    }
}

TEST_F(MotionBlur, GatheredIsAsDrawnAtManyTimesInAnyDirection) {
    for (const Eigen::Vector2d& way : {Eigen::Vector2d(21, 33), {-40, 10}}) {
        move_camera_px(way);
        const ImageF one = alpha(gathered), many = alpha(at_many_times);
        double worst = 0;
        for (std::size_t i = 0; i < one.samples().size(); ++i) {
            worst = std::max(worst, std::abs(static_cast<double>(one.samples()[i]) - many.samples()[i]));
        }
        // A corner that a slanted way passes is blurred by the width of a pixel across it.
        EXPECT_LT(worst, 0.05) << way.transpose();
    }
}

TEST_F(MotionBlur, ItIsTheSameWhoeverMoves) {
    for (const MotionBlurSettings& settings : {gathered, at_many_times}) {
        move_camera_px({24, 12});
        const ImageF by_camera = alpha(settings);
        move_camera_px({0, 0});
        ObjectSettings& square = scene_.objects[0];
        const ObjectSettings still = square;
        square.keys = {{.frame = 0, .translate_m = {-0.24, 0.12, 0}, .scale = square.scale},
                       {.frame = 2, .translate_m = {0.24, -0.12, 0}, .scale = square.scale}};
        const ImageF by_object = alpha(settings);
        square = still;
        double worst = 0;
        for (std::size_t i = 0; i < by_camera.samples().size(); ++i) {
            worst = std::max(worst, std::abs(static_cast<double>(by_camera.samples()[i]) - by_object.samples()[i]));
        }
        EXPECT_LT(worst, 1e-3) << static_cast<int>(settings.level);
    }
}

TEST_F(MotionBlur, AShadowIsSmearedWithTheSurface) {
    scene_.surface.present = true;
    scene_.objects[0].translate_m.z() = 0.02;
    set_square_px(16);
    const CompositedFrame still = composite();
    const ImageF sharp = whole(still, still.layers->shadow, 1);
    move_camera_px({40, 0});
    scene_.effects.motion_blur = gathered;
    const CompositedFrame frame = composite();
    const ImageF seen = whole(frame, frame.layers->shadow, 1);
    ASSERT_TRUE(was_drawn("motion_blur/shadow"));
    double worst = 0, darkest = 1;
    for (int x = 30; x < 98; ++x) {
        double mean = 0;
        for (int i = -10; i <= 10; ++i) {
            // 20 pixels around this one: whole ones, and half of the outermost.
            mean += (std::abs(i) == 10 ? 0.5 : 1.0) / 20 * sharp.at(x + i, 32, 1);
        }
        darkest = std::min(darkest, mean);
        worst = std::max(worst, std::abs(seen.at(x, 32, 1) - mean));
    }
    EXPECT_LT(darkest, 0.9);
    EXPECT_LT(worst, 0.005) << "half a code value of 8 bits is 0.002 of the light or more";
}

TEST_F(MotionBlur, WhatHardlyMovesIsLeftAlone) {
    const CompositedFrame without = composite(true, false);
    for (const double way_px : {0.0, 0.3}) {  // in half of the frame's time under a quarter of a pixel
        move_camera_px({way_px, 0});
        scene_.effects.motion_blur = gathered;
        const CompositedFrame lean = composite(true, false);
        EXPECT_FALSE(was_drawn("motion_blur/gather"));
        EXPECT_TRUE(std::ranges::any_of(reports_, [](const PassReport& report) {
            return report.name == "motion_blur" && report.why == "nothing moves by a quarter of a pixel";
        }));
        const CompositedFrame whole_frame = composite(false, false);
        EXPECT_TRUE(was_drawn("motion_blur/gather"));
        EXPECT_TRUE(std::ranges::equal(lean.rgb16().samples(), whole_frame.rgb16().samples())) << way_px;
        EXPECT_TRUE(std::ranges::equal(lean.rgb16().samples(), without.rgb16().samples())) << way_px;
    }
}

TEST_F(MotionBlur, TilesAreTheWholeFrame) {
    scene_.surface.present = true;
    scene_.objects[0].translate_m.z() = 0.02;
    move_camera_px({40, 22});
    scene_.effects.motion_blur = gathered;
    const CompositedFrame lean = composite(true, false), everything = composite(false, false);
    EXPECT_LT(lean.reach.width, width);
    EXPECT_TRUE(std::ranges::equal(lean.rgb16().samples(), everything.rgb16().samples()));
}

TEST_F(MotionBlur, ASolveWithoutAShutterIsSaidSo) {
    move_camera_px({40, 0});
    scene_.effects.motion_blur = MotionBlurSettings{};
    composite();
    EXPECT_FALSE(was_drawn("motion_blur/gather"));
    EXPECT_TRUE(std::ranges::any_of(warnings_.entries(), [](const auto& entry) {
        return entry.text.find("motion blur is left out: the solve does not say") != std::string::npos;
    }));
    solve_.frames[2].shutter_fraction = 0.5;
    composite();
    EXPECT_TRUE(was_drawn("motion_blur/gather")) << "the nearest frame's shutter";
}

}  // namespace
}  // namespace matchlight
