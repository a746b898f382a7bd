// The shadow on the real surface out of focus, in whole frames, against rays through the lens in double precision.
#include "render/effects/surface_defocus.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compositor/compositor.h"
#include "compositor/surface_focus.h"
#include "gl_fixture.h"
#include "grey_plate.h"
#include "render/effects/bokeh.h"
#include "report/surface_defocus_reference.h"

namespace matchlight {
namespace {

constexpr int width = 128, height = 96;
constexpr double focal_px = 100;

class SurfaceDefocusTest : public GlTest {
protected:
    void SetUp() override {
        GlTest::SetUp();
        warnings_.set_quiet(true);
        solve_ = solve_of(width, height, focal_px);
        scene_ = load_scene(std::filesystem::path(MATCHLIGHT_SOURCE_DIR) / "samples/table/table.toml", warnings_);
        ObjectSettings box;
        box.shape = "box";
        box.name = "box";
        box.scale = {0.12, 0.05, 0.1};
        box.translate_m.z() = 0.06;
        scene_.objects = {box};
        look_along({0, 0, 1}, {0, 0, -1});
    }

    static Solve solve_of(int frame_width, int frame_height, double fx) {
        Solve solve;
        solve.footage_file = "clip";
        solve.camera.width = frame_width;
        solve.camera.height = frame_height;
        solve.camera.fx = solve.camera.fy = fx;
        solve.camera.cx = (frame_width - 1) / 2.0;
        solve.camera.cy = (frame_height - 1) / 2.0;
        SolvedFrame frame;
        frame.exposure_ev = 0;
        solve.frames.push_back(frame);
        return solve;
    }
    void look_along(const Eigen::Vector3d& eye, const Eigen::Vector3d& along) {
        solve_.frames[0].camera_from_world = camera_looking_along(eye, along.normalized());
    }
    void focus(double distance_m, double coc_scale_px_m, const BokehSettings& bokeh = {}) {
        DepthOfFieldSettings lens;
        lens.focus_distance_m = distance_m;
        lens.coc_scale_px_m = coc_scale_px_m;
        lens.bokeh = bokeh;
        scene_.effects.depth_of_field = lens;
    }
    CompositedFrame composite_of(const Scene& scene, const Solve& solve, const CompositorOptions& with) {
        CompositorOptions options = with;
        options.settings = without_rays(Quality{.supersampling = 1,
                                                .mirror_face_px = 16,
                                                .shadow = {.directions = 16, .resolution = 512},
                                                .object_shadow = {.directions = 0},
                                                .depth_of_field = level_});
        Compositor compositor(context(), scene, solve, options, warnings_);
        CompositedFrame frame = compositor.composite(test::grey_plate(solve.camera.width, solve.camera.height));
        reports_ = compositor.reports();
        return frame;
    }
    CompositedFrame composite(bool leave_out = true) { return composite_of(scene_, solve_, {.leave_out = leave_out}); }
    ImageF shadow_of(const Scene& scene, const Solve& solve) {
        const CompositedFrame frame = composite_of(scene, solve, {.layers = true});
        ImageF image(solve.camera.width, solve.camera.height, 3, 1);
        if (!frame.layers) return image;
        const Region& region = frame.layers->region;
        for (int y = 0; y < region.height; ++y) {
            std::ranges::copy(frame.layers->shadow.row(y), image.pixel(region.x, region.y + y));
        }
        return image;
    }
    ImageF shadow() { return shadow_of(scene_, solve_); }
    /// The sharp shadow as the surface's texture: seen from straight above, four pixels a centimetre.
    SurfaceRatio texture() {
        Scene sharp = scene_;
        sharp.effects.depth_of_field.reset();
        Solve above = solve_of(800, 800, 400);
        above.frames[0].camera_from_world = camera_looking_along({0, 0, 1}, {0, 0, -1});
        const RigidTransform camera_from_world = *above.frames[0].camera_from_world;
        return [image = shadow_of(sharp, above), camera_from_world, camera = above.camera](const Eigen::Vector2d& m) {
            const Eigen::Vector2d at = camera.pixel_from_camera(camera_from_world * Eigen::Vector3d(m.x(), m.y(), 0));
            const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
            const double u = at.x() - x, v = at.y() - y;
            const auto pixel = [&](int i, int j) -> Eigen::Vector3d {
                if (!image.bounds().contains(i, j)) return Eigen::Vector3d::Ones();
                return Eigen::Map<const Eigen::Vector3f>(image.pixel(i, j)).cast<double>();
            };
            return Eigen::Vector3d((1 - v) * ((1 - u) * pixel(x, y) + u * pixel(x + 1, y)) +
                                   v * ((1 - u) * pixel(x, y + 1) + u * pixel(x + 1, y + 1)));
        };
    }
    SurfaceLensView view() const {
        const DepthOfFieldSettings& lens = *scene_.effects.depth_of_field;
        return {.camera_from_world = *solve_.frames[0].camera_from_world,
                .focus = {.coc_scale_px_m = *lens.coc_scale_px_m, .focus_distance_m = *lens.focus_distance_m},
                .focal_px = focal_px,
                .bokeh = lens.bokeh,
                .lens_steps = 32};
    }
    /// Of every third pixel: how far it is from the reference.
    struct Errors {
        double mean = 0;
        double largest_over_bound = 0;
        double darkest = 1;  // of the reference
    };
    Errors errors(const SurfaceRatio& ratio) {
        const ImageF seen = shadow();
        const SurfaceLensView lens = view();
        const LensMap lens_map = make_lens_map(solve_.camera);
        const SurfaceFocus focus(lens.focus, 0, lens.camera_from_world, lens_map, solve_.camera);
        Errors errors;
        int count = 0;
        for (int y = 0; y < height; y += 3) {
            for (int x = 0; x < width; x += 3) {
                const double coc_px = std::max(std::abs(focus.coc_px(x, y)), 1.0);
                // Where an edge crosses a disc of few texels, two of them may count or not; wide discs have six of
                // them across or more.
                const double across = std::min(coc_px, 6.0);
                const double texels = bokeh_area(lens.bokeh) / 4 * across * across;
                const double bound = 0.02 + 2 / texels;
                const double expected =
                    reference_surface_ratio(lens, solve_.camera.normalized_from_pixel({x, y}), ratio)[1];
                const double error = std::abs(seen.at(x, y, 1) - expected);
                errors.largest_over_bound = std::max(errors.largest_over_bound, error / bound);
                errors.mean += error;
                errors.darkest = std::min(errors.darkest, expected);
                ++count;
            }
        }
        errors.mean /= count;
        return errors;
    }
    bool was_drawn(const std::string& pass) const {
        return std::ranges::any_of(reports_,
                                   [&](const PassReport& report) { return report.name == pass && report.drawn; });
    }
    bool was_left_out(const std::string& why) const {
        return std::ranges::any_of(
            reports_, [&](const PassReport& report) { return report.name == "surface defocus" && report.why == why; });
    }

    Warnings warnings_;
    Scene scene_;
    Solve solve_;
    QualityLevel level_ = QualityLevel::final_;
    std::vector<PassReport> reports_;
};

TEST_F(SurfaceDefocusTest, IsTheMeanOverTheLens) {
    const BokehSettings triangle{.blades = 3, .rotation_deg = 20};
    const SurfaceRatio ratio = texture();
    for (const Eigen::Vector3d& along : {Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(0.1, 0.5, -0.55)}) {
        look_along(-0.6 * along.normalized(), along);
        for (const auto& [focus_m, coc_scale_px_m] :
             {std::pair{0.35, 4.0}, {0.35, 30.0}, {0.55, 20.0}, {0.7, 60.0}, {2.0, 10.0}}) {
            for (const BokehSettings& bokeh : {BokehSettings{}, triangle}) {
                focus(focus_m, coc_scale_px_m, bokeh);
                const Errors found = errors(ratio);
                const std::string what =
                    fmt::format("focus {} m, scale {}, {} blades", focus_m, coc_scale_px_m, bokeh.blades);
                EXPECT_LT(found.largest_over_bound, 1) << what;
                EXPECT_LT(found.mean, 0.002) << what;
                EXPECT_LT(found.darkest, 0.8) << what;
            }
        }
    }
}

TEST_F(SurfaceDefocusTest, QuickLevelsAreNearTheReferenceToo) {
    const SurfaceRatio ratio = texture();
    look_along({-0.05, -0.35, 0.4}, {0.1, 0.5, -0.55});
    focus(0.35, 30);
    double before = 0;
    for (const QualityLevel level :
         {QualityLevel::reference, QualityLevel::final_, QualityLevel::preview, QualityLevel::draft}) {
        level_ = level;
        const Errors found = errors(ratio);
        EXPECT_LT(found.mean, 0.004);
        EXPECT_GT(found.mean, 0.9 * before) << "what costs less is not better";
        before = found.mean;
    }
}

TEST_F(SurfaceDefocusTest, NoShadowIsLost) {
    // Seen straight from above all of it is as far away.
    const auto lost = [&] {
        const ImageF left = shadow();
        double sum = 0;
        for (const float ratio : left.samples()) sum += 1 - ratio;
        return sum;
    };
    scene_.objects[0].scale = {0.06, 0.05, 0.03};
    scene_.objects[0].translate_m.z() = 0.016;
    const double sharp = lost();
    EXPECT_GT(sharp, 100);
    for (const double coc_scale_px_m : {4.0, 8.0, 16.0, 32.0}) {
        focus(2, coc_scale_px_m);
        // Half a code is less than what counts as none.
        EXPECT_NEAR(lost() / sharp, 1, 0.01) << coc_scale_px_m;
    }
}

TEST_F(SurfaceDefocusTest, WhatIsLeftOutChangesNothing) {
    look_along({-0.05, -0.35, 0.4}, {0.1, 0.5, -0.55});
    const CompositedFrame plain = composite();
    // Circles of under a quarter pixel all over the shadow.
    focus(0.5, 0.1);
    const CompositedFrame lean = composite();
    EXPECT_TRUE(was_left_out("where its shadow is seen no circle is a quarter pixel wide"));
    const CompositedFrame everything = composite(false);
    EXPECT_TRUE(was_drawn("surface defocus/shadow"));
    EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), lean.rgb16().samples()));
    EXPECT_TRUE(std::ranges::equal(plain.rgb16().samples(), everything.rgb16().samples()));

    scene_.objects[0].casts_shadow = false;
    focus(0.5, 40);
    const CompositedFrame shadowless = composite();
    EXPECT_TRUE(was_left_out("there is no shadow on the real surface"));
    EXPECT_TRUE(std::ranges::equal(shadowless.rgb16().samples(), composite(false).rgb16().samples()));
}

TEST_F(SurfaceDefocusTest, TilesAreTheWholeFrame) {
    // A flat thing whose shadow ends within the frame.
    scene_.objects[0].scale = {0.05, 0.05, 0.002};
    scene_.objects[0].translate_m = {-0.1, 0.05, 0.003};
    for (const QualityLevel level : {QualityLevel::draft, QualityLevel::final_}) {
        level_ = level;
        for (const double coc_scale_px_m : {3.0, 12.0, 40.0}) {
            look_along({-0.05, -0.35, 0.4}, {0.1, 0.5, -0.55});
            focus(0.5, coc_scale_px_m);
            const CompositedFrame lean = composite();
            EXPECT_TRUE(was_drawn("surface defocus/shadow"));
            if (coc_scale_px_m < 20) {
                EXPECT_LT(lean.reach.width * lean.reach.height, width * height) << coc_scale_px_m;
            }
            EXPECT_TRUE(std::ranges::equal(lean.rgb16().samples(), composite(false).rgb16().samples()))
                << coc_scale_px_m;
        }
    }
}

TEST_F(SurfaceDefocusTest, AShadowBeyondTheFrameBlursIntoIt) {
    scene_.objects[0].scale = {0.1, 0.5, 0.002};
    // The frame ends 0.64 m to the right; the shadow begins a centimetre, a pixel, farther.
    scene_.objects[0].translate_m = {0.71, 0, 0.002};
    look_along({0, 0, 1}, {0, 0, -1});
    const auto lost_at_the_rim = [&] { return 1 - shadow().at(width - 1, height / 2, 1); };
    EXPECT_LT(lost_at_the_rim(), 0.1);
    focus(0.5, 16);
    const double expected =
        1 - reference_surface_ratio(view(), solve_.camera.normalized_from_pixel({width - 1, height / 2}), texture())[1];
    EXPECT_GT(expected, 0.2);
    EXPECT_NEAR(lost_at_the_rim(), expected, 0.02);
}

}  // namespace
}  // namespace matchlight
