// Objects that move: a frame is that of a scene whose objects stand where they are in it, in any order of frames.
#include <algorithm>

#include <gtest/gtest.h>

#include "ball_and_box.h"
#include "compositor/compositor.h"
#include "scene/object_motion.h"

namespace matchlight {
namespace {

class MovingObjects : public test::BallAndBox {
protected:
    void SetUp() override {
        set_up(320, 180);
        ObjectSettings& box = scene_.objects[1];
        box.keys = {{.frame = 0, .translate_m = {0.05, 0, 0.03}, .scale = box.scale},
                    {.frame = 2, .translate_m = {0.01, 0, 0.06}, .rotate_deg = {0, 0, 90}, .scale = box.scale}};
    }

    static CompositorOptions options(CompositorOptions with = {}) {
        with.settings = coarse_quality();
        return with;
    }
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
