// Objects that move: a frame is that of a scene whose objects stand where they are in it, in any order of frames.
#include <algorithm>

#include <gtest/gtest.h>

#include "compositor/compositor.h"
#include "gl_fixture.h"
#include "grey_plate.h"
#include "scene/object_motion.h"

namespace matchlight {
namespace {

class MovingObjects : public GlTest {
protected:
    void SetUp() override {
        GlTest::SetUp();
        warnings_.set_quiet(true);
        const std::filesystem::path folder = std::filesystem::path(MATCHLIGHT_SOURCE_DIR) / "samples/table";
        scene_ = load_scene(folder / "table.toml", warnings_);
        solve_.camera = camera_for_size(load_camera(folder / "camera.yaml"), 320, 180, folder / "camera.yaml");
        for (std::int64_t i = 0; i < 4; ++i) {
            SolvedFrame frame;
            frame.frame = i;
            frame.time_s = static_cast<double>(i) / 25;
            frame.camera_from_world = test::camera_before_the_table();
            frame.exposure_ev = -1;
            solve_.frames.push_back(frame);
        }
        ObjectSettings ball, box;
        ball.shape = "sphere";
        ball.name = "ball";
        ball.scale.setConstant(0.05);
        ball.translate_m = {-0.06, 0, 0.03};
        box.shape = "box";
        box.name = "box";
        box.scale.setConstant(0.06);
        box.translate_m = {0.05, 0, 0.03};
        box.keys = {{.frame = 0, .translate_m = {0.05, 0, 0.03}, .scale = box.scale},
                    {.frame = 2, .translate_m = {0.01, 0, 0.06}, .rotate_deg = {0, 0, 90}, .scale = box.scale}};
        scene_.objects = {ball, box};
    }

    /// Coarse, so that maps are made quickly.
    static CompositorOptions options(CompositorOptions with = {}) {
        with.settings = Quality{.supersampling = 1,
                                .mirror_face_px = 32,
                                .shadow = {.directions = 8, .resolution = 64},
                                .object_shadow = {.directions = 4, .resolution = 32},
                                .reflection = {.lobe_rays = 1, .bounces = 1},
                                .bounce = {.rays = 4, .surface_rays = 4, .bounces = 1, .surface_points = 8}};
        return with;
    }
    PlateFrame plate(std::int64_t frame) const { return test::grey_plate(320, 180, 120, frame); }
    /// The scene as it is at a frame, with nothing that moves.
    Scene standing_as_at(std::int64_t frame) const {
        Scene still = scene_;
        ObjectSettings& box = still.objects[1];
        box.keys = {box.keys[frame == 0 ? 0 : 1]};
        return still;
    }
    static bool same(const CompositedFrame& a, const CompositedFrame& b) {
        return std::ranges::equal(a.rgb16().samples(), b.rgb16().samples());
    }
    static int made(const Compositor& compositor, const std::string& pass) {
        int drawn = 0;
        for (const PassReport& report : compositor.reports()) drawn += report.name == pass && report.drawn;
        return drawn;
    }

    Warnings warnings_;
    Scene scene_;
    Solve solve_;
};

TEST_F(MovingObjects, AFrameIsThatOfAStillSceneInAnyOrder) {
    Compositor moving(context(), scene_, solve_, options(), warnings_);
    std::vector<CompositedFrame> first;
    for (const std::int64_t frame : {2, 0, 1}) first.push_back(moving.composite(plate(frame)));
    EXPECT_FALSE(same(first[0], first[1]));
    EXPECT_TRUE(same(moving.composite(plate(0)), first[1])) << "the same frame, drawn after another one";
    EXPECT_TRUE(same(moving.composite(plate(2)), first[0]));
    for (const std::int64_t frame : {0, 2}) {
        Compositor still(context(), standing_as_at(frame), solve_, options(), warnings_);
        EXPECT_TRUE(same(still.composite(plate(0)), first[frame == 0 ? 1 : 0])) << "shadows and all, at " << frame;
    }
}

TEST_F(MovingObjects, WhatIsLeftOutChangesNothing) {
    Compositor lean(context(), scene_, solve_, options(), warnings_);
    Compositor whole(context(), scene_, solve_, options({.leave_out = false}), warnings_);
    for (const std::int64_t frame : {1, 3}) {
        EXPECT_TRUE(same(lean.composite(plate(frame)), whole.composite(plate(frame)))) << frame;
    }
}

TEST_F(MovingObjects, AtRestTheirLightStaysAsItIs) {
    Compositor compositor(context(), scene_, solve_, options({.timed = true}), warnings_);
    const auto ms_of_contact_shadow = [&] {
        for (const PassReport& report : compositor.reports()) {
            if (report.name == "shadow/contact") return report.why;
        }
        return std::string();
    };
    compositor.composite(plate(2));
    const std::string at_the_last_key = ms_of_contact_shadow();
    EXPECT_NE(at_the_last_key.find("made once for where the objects stand, in"), std::string::npos);
    compositor.composite(plate(3));
    EXPECT_EQ(ms_of_contact_shadow(), at_the_last_key) << "the very same map, by the time it took";
    compositor.composite(plate(1));
    EXPECT_NE(ms_of_contact_shadow(), "");
    EXPECT_EQ(made(compositor, "shadow/contact"), 0) << "made before the frame, whose reach it sets";
}

TEST_F(MovingObjects, OneThatCastsNothingLeavesTheShadowOnTheSurface) {
    scene_.objects[1].casts_shadow = false;
    Compositor compositor(context(), scene_, solve_, options({.timed = true}), warnings_);
    const auto times = [&](std::int64_t frame) {
        compositor.composite(plate(frame));
        std::pair<std::string, std::string> why;
        for (const PassReport& report : compositor.reports()) {
            if (report.name == "shadow/contact") why.first = report.why;
            if (report.name == "shadow/between objects") why.second = report.why;
        }
        return why;
    };
    const auto before = times(0), after = times(1);
    EXPECT_EQ(before.first, after.first) << "not made anew";
    EXPECT_NE(before.second, "");
}

}  // namespace
}  // namespace matchlight
