// Models whose vertices move: a frame is that of a model that stands as the animation has it then, light, shadow, rays
// and all, and blurs as it would if the whole object moved.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "animated_box.h"
#include "ball_and_box.h"
#include "compositor/compositor.h"

namespace matchlight {
namespace {

class AnimatedModels : public test::BallAndBox {
protected:
    void SetUp() override {
        set_up(320, 180);
        folder_ = std::filesystem::temp_directory_path() / ("matchlight-animated-" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
        scene_.objects[1].shape.clear();
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    /// The box's model is one that moves so.
    void set_box(Scene& scene, const std::string& name, const test::BoxMotion& motion) const {
        const std::filesystem::path file = folder_ / name;
        std::ofstream(file, std::ios::binary) << test::box_glb(motion);
        scene.objects[1].model = file;
    }
    static CompositorOptions options(const Quality& quality = coarse_quality()) {
        CompositorOptions with;
        with.settings = quality;
        return with;
    }
    static bool same(const CompositedFrame& a, const CompositedFrame& b) {
        return std::ranges::equal(a.rgb16().samples(), b.rgb16().samples());
    }
    /// The greatest difference, as a share of the brightest code.
    static double difference(const CompositedFrame& a, const CompositedFrame& b) {
        const auto first = a.rgb16(), second = b.rgb16();
        double most = 0;
        for (std::size_t i = 0; i < first.samples().size(); ++i) {
            most = std::max(
                most, std::abs(static_cast<double>(first.samples()[i]) - static_cast<double>(second.samples()[i])));
        }
        return most / 65535;
    }

    std::filesystem::path folder_;
};

TEST_F(AnimatedModels, AFrameIsThatOfAModelThatStandsSoInAnyOrder) {
    // Frames are 0.04 s apart; halves and quarters are exact in floats.
    const test::BoxMotion motion{.times_s = {0, 0.04F, 0.08F}, .translations = {0, 0, 0, -0.5, 0.25, 0, -1, 0, 0.5}};
    set_box(scene_, "moving.glb", motion);
    scene_.objects[1].animation.loop = false;
    Compositor moving(context(), scene_, solve_, options(), warnings_);
    std::vector<CompositedFrame> frames;
    for (const std::int64_t frame : {2, 0, 3}) frames.push_back(moving.composite(plate(frame)));
    EXPECT_FALSE(same(frames[0], frames[1]));
    EXPECT_TRUE(same(frames[2], frames[0])) << "held at its end";
    EXPECT_TRUE(same(moving.composite(plate(0)), frames[1])) << "the same frame, drawn after another one";
    Scene still = scene_;
    set_box(still, "still.glb", {.times_s = {}, .translations = {}, .place = {-1, 0, 0.5}});
    Compositor standing(context(), still, solve_, options(), warnings_);
    EXPECT_TRUE(same(standing.composite(plate(0)), frames[0])) << "shadows, rays and all";
}

TEST_F(AnimatedModels, BlurAsWhatMovesWhole) {
    // 0.6 m to the side in model's units of 0.06 m a second: keys of the object do the same.
    scene_.effects.motion_blur = MotionBlurSettings{};
    scene_.effects.motion_blur->shutter = 0.5;
    Scene keyed = scene_;
    set_box(scene_, "moving.glb", {.times_s = {0, 0.12F}, .translations = {0, 0, 0, 2, 0, 0}});
    set_box(keyed, "still.glb", {.times_s = {}, .translations = {}});
    const ObjectSettings& box = keyed.objects[1];
    ObjectKey first{.frame = 0, .translate_m = box.translate_m, .scale = box.scale}, last = first;
    last.frame = 3;
    last.translate_m.x() += 2 * box.scale.x();
    keyed.objects[1].keys = {first, last};
    Quality quality = coarse_quality();
    quality = without_rays(quality);
    Compositor animated(context(), scene_, solve_, options(quality), warnings_);
    Compositor whole(context(), keyed, solve_, options(quality), warnings_);
    const CompositedFrame blurred = animated.composite(plate(1));
    // The same ways, rounded to floats at other places.
    EXPECT_LT(difference(blurred, whole.composite(plate(1))), 2.0 / 255);
    scene_.effects.motion_blur.reset();
    Compositor sharp(context(), scene_, solve_, options(quality), warnings_);
    EXPECT_GT(difference(blurred, sharp.composite(plate(1))), 10.0 / 255);
}

}  // namespace
}  // namespace matchlight
