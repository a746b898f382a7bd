// Clipped pixels that no other frame knows: their neighbours' colour, where a channel tells how bright they are.
#include "compositor/clipped_plate.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

class ClippedByEveryFrame : public testing::Test {
protected:
    static constexpr int size_px = 64;

    ClippedByEveryFrame() {
        camera_.width = camera_.height = size_px;
        camera_.fx = camera_.fy = 100;
        camera_.cx = camera_.cy = 31.5;
        lens_map_ = make_lens_map(camera_);
        optics_.camera_from_world = camera_looking_along({0, 0, 1}, {0, 0, -1});
        optics_.frame_width = optics_.frame_height = size_px;
    }

    /// Paper of one colour under light that grows towards the middle, as a camera with a straight response has it.
    static Eigen::Vector3d light_at(int x, int y, double brightest) {
        const double near = std::max(0.0, 1 - std::hypot(x - 31.5, y - 31.5) / 24);
        return (0.4 + (brightest - 0.4) * near) * Eigen::Vector3d(1, 0.5, 0.4);
    }
    static ImageF code_of(double brightest) {
        ImageF code(size_px, size_px, 3);
        for (int y = 0; y < size_px; ++y) {
            for (int x = 0; x < size_px; ++x) {
                for (int c = 0; c < 3; ++c)
                    code.at(x, y, c) = static_cast<float>(std::min(light_at(x, y, brightest)[c], 1.0));
            }
        }
        return code;
    }
    ClippedPlate unclip(const ImageF& code) const {
        const Region frame{0, 0, size_px, size_px};
        return unclip_plate(code, frame, {frame},
                            {.gathered = nullptr,
                             .surface_z_m = 0,
                             .optics = optics_,
                             .lens_map = lens_map_,
                             .in_shadow = [](const Eigen::AlignedBox2d&) { return true; },
                             .light_from_code = [](float value, int) { return static_cast<double>(value); },
                             .rec709_from_footage = rec709_from(Primaries::rec709)});
    }

    Camera camera_;
    LensMap lens_map_;
    FrameOptics optics_;
};

TEST_F(ClippedByEveryFrame, a_channel_that_clips_follows_from_those_that_do_not) {
    const ImageF code = code_of(1.8);
    const ClippedPlate plate = unclip(code);
    ASSERT_FALSE(plate.known.empty());
    int clipped = 0;
    for (int y = 0; y < size_px; ++y) {
        for (int x = 0; x < size_px; ++x) {
            if (code.at(x, y, 0) < 0.98f) {
                EXPECT_EQ(plate.bound.at(x, y), 0);
                EXPECT_EQ(plate.known.at(x, y, 3), 0);
                continue;
            }
            ++clipped;
            EXPECT_EQ(plate.bound.at(x, y), 0.5f) << "told apart from what other frames know";
            EXPECT_EQ(plate.known.at(x, y, 3), 1);
            const Eigen::Vector3d truth = light_at(x, y, 1.8);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(plate.known.at(x, y, c), truth[c], 1e-5 * truth[c]);
        }
    }
    EXPECT_GT(clipped, 300);
    EXPECT_EQ(plate.neighbours, clipped);
    EXPECT_EQ(plate.bounds, 0);
}

TEST_F(ClippedByEveryFrame, what_clips_in_all_channels_stays_a_bound) {
    const ImageF code = code_of(6);
    const ClippedPlate plate = unclip(code);
    EXPECT_EQ(plate.bound.at(31, 31), 1);
    EXPECT_EQ(plate.known.at(31, 31, 3), 0);
    EXPECT_GT(plate.bounds, 50);
    EXPECT_GT(plate.neighbours, 50);
}

TEST_F(ClippedByEveryFrame, nothing_near_that_does_not_clip_tells_no_colour) {
    ImageF code(size_px, size_px, 3, 0.5f);
    for (int i = 0; i < size_px * size_px; ++i) code.pixel(i % size_px, i / size_px)[0] = 1;
    const ClippedPlate plate = unclip(code);
    EXPECT_TRUE(plate.known.empty());
    EXPECT_EQ(plate.bounds, size_px * size_px);
    EXPECT_EQ(plate.neighbours, 0);
}

TEST_F(ClippedByEveryFrame, a_colour_that_is_dimmer_than_the_bound_does_not_take_light_away) {
    // A red lamp spot on grey paper: its neighbours say less red than it shows.
    ImageF code(size_px, size_px, 3, 0.5f);
    for (int y = 28; y < 36; ++y) {
        for (int x = 28; x < 36; ++x) code.at(x, y, 0) = 1;
    }
    const ClippedPlate plate = unclip(code);
    EXPECT_EQ(plate.neighbours, 64);
    EXPECT_EQ(plate.known.at(30, 30, 0), 1);
}

}  // namespace
}  // namespace matchlight
