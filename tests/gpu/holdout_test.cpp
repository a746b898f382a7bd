// Shapes of real things hide what is virtual behind them, and are never seen themselves.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <unistd.h>

#include "compositor_shot.h"

namespace matchlight::test {
namespace {

/// A box as wide and high as the ball, between it and the camera.
ObjectSettings box_before_the_ball() {
    ObjectSettings box;
    box.shape = "box";
    box.name = "real box";
    box.holdout = true;
    box.scale = {0.1, 0.02, 0.12};
    box.translate_m = {0, -0.06, 0.06};
    return box;
}

class Holdout : public CompositorTest {
protected:
    Holdout() { shot_.scene.surface.shadow = false; }

    static std::int64_t touched(const CompositedFrame& frame) {
        return std::ranges::count_if(frame.touched.samples(), [](std::uint8_t one) { return one != 0; });
    }
    CompositedFrame with_layers() {
        Warnings warnings;
        warnings.set_quiet(true);
        Compositor compositor(context(), shot_.scene, shot_.solve, {.quality = shot_.scene.quality, .layers = true},
                              warnings);
        return compositor.composite(grey_plate(320, 180, plate_luma_));
    }

    Shot shot_ = make_shot();
};

TEST_F(Holdout, alone_it_leaves_the_plate_as_it_came) {
    shot_.scene.objects = {box_before_the_ball()};
    const CompositedFrame frame = composite(shot_, true);
    EXPECT_EQ(touched(frame), 0);
    EXPECT_TRUE(std::ranges::equal(frame.rgb16().samples(), frame.plate.rgb16({0, 0, 320, 180}).samples()));
}

TEST_F(Holdout, what_is_wholly_behind_it_is_gone) {
    const std::int64_t ball = touched(composite(shot_, true));
    ASSERT_GT(ball, 500);
    shot_.scene.objects.push_back(box_before_the_ball());
    EXPECT_EQ(touched(composite(shot_, true)), 0);
}

TEST_F(Holdout, spheres_hide_and_are_not_seen_themselves) {
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / fmt::format("matchlight_holdout_{}.xyz", ::getpid());
    std::ofstream(file) << "1\n\nO 0 0 0\n";
    ObjectSettings ball;
    ball.spheres = file;
    ball.name = "real ball";
    ball.sphere.radius = 1;
    ball.holdout = true;
    const ObjectSettings& hidden = shot_.scene.objects.front();
    ball.translate_m = hidden.translate_m;
    ball.scale = 0.55 * hidden.scale;  // a tenth larger: a shape's radius is ½
    const CompositedFrame alone = composite(shot_, true);
    shot_.scene.objects.push_back(ball);
    EXPECT_EQ(touched(composite(shot_, true)), 0) << "the ball within it";

    // Before a half of it, and as the built-in shape hides.
    shot_.scene.objects.back().translate_m += Eigen::Vector3d(0.5, -0.5, 0).cwiseProduct(ball.scale);
    const CompositedFrame by_spheres = composite(shot_, true);
    ObjectSettings& shape = shot_.scene.objects.back();
    shape.spheres.clear();
    shape.shape = "sphere";
    shape.scale *= 2;  // its radius is ½
    const CompositedFrame by_shape = composite(shot_, true);
    std::filesystem::remove(file);
    EXPECT_LT(touched(by_shape), touched(alone) - 200);
    EXPECT_NEAR(static_cast<double>(touched(by_spheres)), static_cast<double>(touched(by_shape)), 4);
}

TEST_F(Holdout, what_is_before_it_is_as_without_it) {
    const CompositedFrame without = composite(shot_, true);
    ObjectSettings behind = box_before_the_ball();
    behind.translate_m.y() = 0.2;
    behind.casts_shadow = false;
    shot_.scene.objects.insert(shot_.scene.objects.begin(), behind);
    const CompositedFrame with = composite(shot_, true);
    EXPECT_TRUE(std::ranges::equal(without.rgb16().samples(), with.rgb16().samples()));
}

TEST_F(Holdout, hides_in_every_layer_and_with_soft_edges) {
    // Its right side stands upright in the middle of the ball.
    ObjectSettings box = box_before_the_ball();
    box.translate_m.x() = -0.05;
    shot_.scene.objects.push_back(box);
    shot_.scene.quality = QualityLevel::final_;
    const CompositedFrame frame = with_layers();
    ASSERT_TRUE(frame.layers);
    const FrameLayers& layers = *frame.layers;
    int seen_left = 0, seen_right = 0, partly = 0, contradicted = 0;
    for (int y = 0; y < layers.region.height; ++y) {
        for (int x = 0; x < layers.region.width; ++x) {
            const float alpha = layers.alpha.at(x, y);
            const bool has_id = layers.object_id.at(x, y) > 0;
            EXPECT_TRUE(!has_id || layers.object_id.at(x, y) == 1) << "the box has no id of its own in the picture";
            if (has_id != (layers.depth.at(x, y) > 0)) ++contradicted;
            if (alpha >= 1 && !has_id) ++contradicted;
            if (alpha == 0 && has_id) ++contradicted;
            (layers.region.x + x < 155 ? seen_left : seen_right) += alpha > 0;
            partly += alpha > 0.1F && alpha < 0.9F;
        }
    }
    EXPECT_EQ(contradicted, 0);
    EXPECT_EQ(seen_left, 0);
    EXPECT_GT(seen_right, 300);
    EXPECT_GT(partly, 20) << "edges are antialiased";
}

TEST_F(Holdout, both_sides_hide_and_an_edge_is_a_line) {
    const std::int64_t ball = touched(composite(shot_, true));
    ObjectSettings plane;
    plane.shape = "plane";
    plane.holdout = true;
    plane.translate_m = {0, -0.06, 0.05};
    plane.scale = {0.2, 0.2, 1};
    // Seen from behind as from before.
    for (const double tilt : {90.0, -90.0}) {
        plane.rotate_deg = {tilt, 0, 0};
        shot_.scene.objects.resize(1);
        shot_.scene.objects.push_back(plane);
        EXPECT_EQ(touched(composite(shot_, true)), 0) << tilt;
    }
    // Edge on to the camera, which sees x = 0 as a line: nothing is hidden but that line.
    plane.rotate_deg = {0, 90, 0};
    shot_.scene.objects.back() = plane;
    const std::int64_t beside_edge = touched(composite(shot_, true));
    EXPECT_LE(beside_edge, ball);
    EXPECT_GE(beside_edge, ball - 60) << "a line through the ball, at most a pixel wide";
}

}  // namespace
}  // namespace matchlight::test
