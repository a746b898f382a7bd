// One texel of the real surface from several frames: the majority's light, with clipped values as bounds.
#include "compositor/surface_texel.h"

#include <gtest/gtest.h>

namespace matchlight {
namespace {

SurfaceSample grey(double radiance, double weight = 1, bool clipped = false) {
    const double deviation = 0.02;
    return {.radiance = {radiance, radiance, radiance},
            .deviation = {deviation, deviation, deviation},
            .clipped = {clipped, clipped, clipped},
            .weight = weight};
}

TEST(SurfaceTexel, nothing_seen_is_unknown) {
    EXPECT_EQ(agreed_texel({}).knowledge, 0);
}

TEST(SurfaceTexel, frames_that_agree_are_averaged_by_weight) {
    const SurfaceSample samples[] = {grey(0.50, 1), grey(0.52, 3)};
    const SurfaceTexel texel = agreed_texel(samples);
    EXPECT_DOUBLE_EQ(texel.radiance[1], 0.515);
    EXPECT_EQ(texel.knowledge, 1);
    EXPECT_FALSE(texel.clipped);
}

TEST(SurfaceTexel, a_hand_in_two_frames_of_six_leaves_no_trace) {
    const SurfaceSample samples[] = {grey(0.5), grey(0.1), grey(0.5), grey(0.12), grey(0.5), grey(0.5)};
    const SurfaceTexel texel = agreed_texel(samples);
    EXPECT_DOUBLE_EQ(texel.radiance[0], 0.5);
    EXPECT_EQ(texel.knowledge, 1);
}

TEST(SurfaceTexel, frames_that_all_disagree_know_nothing) {
    const SurfaceSample samples[] = {grey(0.1), grey(0.3), grey(0.5), grey(0.7), grey(0.9)};
    EXPECT_EQ(agreed_texel(samples).knowledge, 0);
}

TEST(SurfaceTexel, an_unclipped_frame_tells_what_clipped_ones_bound) {
    const SurfaceSample samples[] = {grey(0.6, 1, true), grey(0.9, 1), grey(0.7, 1, true)};
    const SurfaceTexel texel = agreed_texel(samples);
    EXPECT_DOUBLE_EQ(texel.radiance[2], 0.9);
    EXPECT_FALSE(texel.clipped);
    EXPECT_EQ(texel.knowledge, 1);
}

TEST(SurfaceTexel, where_all_clip_the_highest_bound_is_kept_and_flagged) {
    const SurfaceSample samples[] = {grey(0.6, 1, true), grey(0.9, 1, true), grey(0.7, 1, true)};
    const SurfaceTexel texel = agreed_texel(samples);
    EXPECT_DOUBLE_EQ(texel.radiance[0], 0.9);
    EXPECT_TRUE(texel.clipped);
    EXPECT_EQ(texel.knowledge, 1);
}

TEST(SurfaceTexel, a_dark_hand_is_no_better_knowledge_than_most_frames_clipping) {
    const SurfaceSample samples[] = {grey(0.9, 1, true), grey(0.9, 1, true), grey(0.1), grey(0.9, 1, true)};
    const SurfaceTexel texel = agreed_texel(samples);
    EXPECT_NEAR(texel.radiance[0], 0.9, 1e-12);
    EXPECT_TRUE(texel.clipped);
}

TEST(SurfaceTexel, one_clipped_channel_leaves_the_others_known) {
    SurfaceSample sample = grey(0.5);
    sample.clipped[0] = true;
    const SurfaceTexel texel = agreed_texel({&sample, 1});
    EXPECT_TRUE(texel.clipped);
    EXPECT_DOUBLE_EQ(texel.radiance[0], 0.5);
    EXPECT_DOUBLE_EQ(texel.radiance[1], 0.5);
}

}  // namespace
}  // namespace matchlight
