// Motion vectors and mattes against what the scene says.
#include "compositor/exchange.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "compositor/compositor.h"
#include "compositor/cryptomatte.h"
#include "gl_fixture.h"
#include "glass_model.h"
#include "grey_plate.h"

namespace matchlight {
namespace {

class Exchange : public GlTest {
protected:
    void SetUp() override {
        GlTest::SetUp();
        warnings_.set_quiet(true);
        const std::filesystem::path folder = std::filesystem::path(MATCHLIGHT_SOURCE_DIR) / "samples/table";
        scene_ = load_scene(folder / "table.toml", warnings_);
        solve_.camera = camera_for_size(load_camera(folder / "camera.yaml"), 320, 180, folder / "camera.yaml");
        for (std::int64_t i = 0; i < 3; ++i) {
            SolvedFrame frame;
            frame.frame = i;
            frame.time_s = static_cast<double>(i) / 25;
            // The camera moves aside, forward and turns, and not evenly.
            const double step = static_cast<double>(i * i) + static_cast<double>(i);
            RigidTransform move = RigidTransform::Identity();
            move.linear() = Eigen::AngleAxisd(0.01 * step, Eigen::Vector3d(0.3, 1, 0.5).normalized()).matrix();
            move.translation() = Eigen::Vector3d(0.004, -0.002, -0.003) * step;
            frame.camera_from_world = move * test::camera_before_the_table();
            frame.exposure_ev = -1;
            solve_.frames.push_back(frame);
        }
        ObjectSettings ball, box;
        ball.shape = "sphere";
        ball.name = "ball";
        ball.scale.setConstant(0.05);
        ball.translate_m = {-0.02, -0.03, 0.03};
        box.shape = "box";
        box.name = "box";
        box.scale.setConstant(0.06);
        for (std::int64_t i = 0; i < 3; ++i)
            box.keys.push_back({.frame = i, .translate_m = box_place_m(i), .scale = box.scale});
        scene_.objects = {ball, box};
    }
    static Eigen::Vector3d box_place_m(std::int64_t frame) {
        return Eigen::Vector3d(0.03, 0.02, 0.03) + 0.004 * static_cast<double>(frame) * Eigen::Vector3d(1, -0.5, 0.5);
    }
    FrameLayers layers_of(const Scene& scene, std::int64_t frame) {
        Compositor compositor(context(), scene, solve_,
                              {.settings = without_rays(Quality{.supersampling = 2,
                                                                .samples = 4,
                                                                .mirror_face_px = 32,
                                                                .shadow = {.directions = 8, .resolution = 64},
                                                                .object_shadow = {.directions = 4, .resolution = 32}}),
                               .layers = true,
                               .exchange = true},
                              warnings_);
        CompositedFrame made = compositor.composite(test::grey_plate(320, 180, 120, frame));
        parts_ = compositor.parts();
        return std::move(made.layers).value();
    }
    /// Coverage of an object in a pixel of a layer.
    static double coverage_of(const Cryptomatte& matte, const std::string& name, int x, int y) {
        const float id = cryptomatte_id(name);
        for (int c = 0; c < 12; c += 2) {
            if (matte.ranks.at(x, y, c) == id) return matte.ranks.at(x, y, c + 1);
        }
        return 0;
    }
    Cryptomatte objects_of(const FrameLayers& layers) const {
        std::vector<std::string> names;
        for (const NamedPart& part : parts_) names.push_back(part.object);
        return make_cryptomatte("CryptoObject", names, layers.parts, layers.alpha);
    }

    Scene scene_;
    Solve solve_;
    Warnings warnings_;
    std::vector<NamedPart> parts_;
};

TEST_F(Exchange, VectorsLeadToWherePointsAreInTheNeighbouringFrames) {
    const FrameLayers layers = layers_of(scene_, 1);
    const LensMap lens = make_lens_map(solve_.camera);
    const RigidTransform world_from_camera = solve_.frames[1].camera_from_world->inverse();
    const Cryptomatte matte = objects_of(layers);
    std::map<int, int> inside, seen;
    for (int y = 0; y < layers.region.height; ++y) {
        for (int x = 0; x < layers.region.width; ++x) {
            const int object = static_cast<int>(layers.object_id.at(x, y));
            // Inside of an outline: there what is nearest is what the depth is of.
            const double own = coverage_of(matte, object == 1 ? "ball" : "box", x, y);
            if (object == 0 || own < 0.999) continue;
            ++inside[object];
            const Eigen::Vector2d pixel(layers.region.x + x, layers.region.y + y);
            const Eigen::Vector3d ray = lens.normalized(pixel.x(), pixel.y()).homogeneous();
            const Eigen::Vector3d point_m = world_from_camera * (layers.depth.at(x, y) * ray);
            for (const auto& [frame, channel] : {std::pair(2, 0), std::pair(0, 2)}) {
                Eigen::Vector3d moved_m = point_m;
                if (object == 2) moved_m += box_place_m(frame) - box_place_m(1);
                const Eigen::Vector2d there =
                    solve_.camera.pixel_from_camera(*solve_.frames[frame].camera_from_world * moved_m);
                const Eigen::Vector2d told(layers.motion.at(x, y, channel), -layers.motion.at(x, y, channel + 1));
                // Where a pixel sees two faces the nearest of its samples lies up to half a pixel beside its middle;
                // elsewhere floats alone differ.
                seen[object] += (there - pixel - told).norm() < 0.03 ? 1 : 0;
                EXPECT_LT((there - pixel - told).norm(), 0.3) << x << ' ' << y;
                EXPECT_GT(told.norm(), 1);
            }
        }
    }
    for (const int object : {1, 2}) {
        EXPECT_GT(inside[object], 150) << object;
        EXPECT_GT(seen[object], 2 * 0.9 * inside[object]) << object;
    }
}

TEST_F(Exchange, TheEndsOfAClipGoOnAsTheirNeighboursDo) {
    const FrameLayers layers = layers_of(scene_, 0);
    int compared = 0;
    for (int y = 0; y < layers.region.height; ++y) {
        for (int x = 0; x < layers.region.width; ++x) {
            if (layers.object_id.at(x, y) != 1) continue;
            ++compared;
            const Eigen::Vector2d forward(layers.motion.at(x, y, 0), layers.motion.at(x, y, 1));
            const Eigen::Vector2d backward(layers.motion.at(x, y, 2), layers.motion.at(x, y, 3));
            EXPECT_GT(forward.norm(), 0.5);
            // The same step of the camera back: perspective makes a little of a difference.
            EXPECT_LT((forward + backward).norm(), 0.1 * forward.norm());
        }
    }
    EXPECT_GT(compared, 200);
}

TEST_F(Exchange, MattesOfOpaqueObjectsShareOutTheCoverage) {
    const FrameLayers layers = layers_of(scene_, 1);
    const Cryptomatte matte = objects_of(layers);
    Scene alone = scene_;
    alone.objects.pop_back();
    const FrameLayers ball = layers_of(alone, 1);
    int edges = 0, shared = 0;
    for (int y = 0; y < layers.region.height; ++y) {
        for (int x = 0; x < layers.region.width; ++x) {
            const double of_ball = coverage_of(matte, "ball", x, y), of_box = coverage_of(matte, "box", x, y);
            const float alpha = layers.alpha.at(x, y);
            EXPECT_NEAR(of_ball + of_box, alpha, 1e-5);
            // The very samples that the light is drawn with, before any scaling; alpha is a mean of half floats.
            double sum = 0;
            for (int slot = 0; slot < 8; ++slot) sum += layers.parts.at(x, y, 2 * slot + 1);
            EXPECT_NEAR(sum, alpha, 1e-3) << x << ' ' << y;
            edges += alpha > 0 && alpha < 1 ? 1 : 0;
            shared += of_ball > 0 && of_box > 0 ? 1 : 0;
            // The ball stands before the box: its matte is what it covers by itself.
            const int alone_x = x + layers.region.x - ball.region.x, alone_y = y + layers.region.y - ball.region.y;
            const bool inside =
                alone_x >= 0 && alone_y >= 0 && alone_x < ball.region.width && alone_y < ball.region.height;
            // Half floats hold coverage, and pixels of the layer may lie otherwise over those of the plate.
            EXPECT_NEAR(of_ball, inside ? ball.alpha.at(alone_x, alone_y) : 0, 0.02) << x << ' ' << y;
        }
    }
    EXPECT_GT(edges, 100);
    EXPECT_GT(shared, 10);
}

TEST_F(Exchange, MattesOfWhatLetsLightThroughAreItsOpacity) {
    const test::GlassModel glass(0.3);
    ObjectSettings& pane = scene_.objects[1];
    pane.keys.clear();
    pane.shape.clear();
    pane.model = glass.path();
    pane.name = "pane";
    pane.scale.setConstant(0.12);
    pane.translate_m = {0, -0.12, 0.08};
    const FrameLayers layers = layers_of(scene_, 1);
    const Cryptomatte matte = objects_of(layers);
    int before_ball = 0, alone = 0;
    double of_pane = 0, of_ball = 0;
    for (int y = 0; y < layers.region.height; ++y) {
        for (int x = 0; x < layers.region.width; ++x) {
            const float alpha = layers.alpha.at(x, y);
            if (std::abs(alpha - 0.3) < 1e-3) {
                ++alone;
                EXPECT_NEAR(coverage_of(matte, "pane", x, y), 0.3, 1e-3);
            }
            if (layers.object_id.at(x, y) != 1 || alpha < 1) continue;
            ++before_ball;
            // Two by two layer pixels of four samples each.
            EXPECT_NEAR(coverage_of(matte, "pane", x, y), 0.3, 1.0 / 16 + 0.01);
            of_pane += coverage_of(matte, "pane", x, y);
            of_ball += coverage_of(matte, "ball", x, y);
        }
    }
    ASSERT_GT(before_ball, 200);
    EXPECT_GT(alone, 1000);
    EXPECT_NEAR(of_pane / before_ball, 0.3, 0.015);
    EXPECT_NEAR(of_ball / before_ball, 0.7, 0.015);
}

TEST_F(Exchange, ObjectsOfOneNameHaveMattesOfTheirOwn) {
    scene_.objects[1].name = "ball";
    layers_of(scene_, 1);
    ASSERT_EQ(parts_.size(), 2U);
    EXPECT_EQ(parts_[0].object, "ball");
    EXPECT_EQ(parts_[1].object, "ball 2");
}

}  // namespace
}  // namespace matchlight
