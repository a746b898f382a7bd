// Frames come as they are asked for, in any order, with few seeks, and damaged ones are passed over.
#include "preview/frame_cache.h"

#include <set>
#include <vector>

#include <gmock/gmock.h>

#include "media/blank_source.h"

namespace matchlight {
namespace {

/// Blank frames, some of which cannot be decoded; writes down what is asked of it.
class NotedSource : public FrameSource {
public:
    struct Notes {
        std::vector<std::int64_t> seeks;
        int decoded = 0;
    };

    NotedSource(int frames, std::set<std::int64_t> damaged, Notes& notes)
        : blank_({.path = "blank", .width = 64, .height = 32, .frames = frames, .fps = 25}),
          damaged_(std::move(damaged)),
          notes_(notes) {}

    const FootageInfo& info() const override { return blank_.info(); }
    std::optional<PlateFrame> next() override {
        std::optional<PlateFrame> frame = blank_.next();
        while (frame && damaged_.contains(frame->index())) frame = blank_.next();
        notes_.decoded += frame ? 1 : 0;
        return frame;
    }
    void seek(std::int64_t frame) override {
        notes_.seeks.push_back(frame);
        blank_.seek(frame);
    }

private:
    BlankSource blank_;
    std::set<std::int64_t> damaged_;
    Notes& notes_;
};

class FrameCacheTest : public testing::Test {
protected:
    /// Of 64 × 32 pixels, as R'G'B'.
    static constexpr std::size_t frame_bytes = 3 * 64 * 32;

    FrameCache cache_of(int frames, const std::set<std::int64_t>& damaged = {}, std::size_t held = 1000) {
        return FrameCache(std::make_unique<NotedSource>(frames, damaged, notes_), held * frame_bytes);
    }
    static std::int64_t index_of(const std::optional<PlateFrame>& frame) { return frame ? frame->index() : -1; }

    NotedSource::Notes notes_;
};

TEST_F(FrameCacheTest, reads_on_without_seeking) {
    FrameCache cache = cache_of(30);
    for (int frame = 0; frame < 30; ++frame) ASSERT_EQ(index_of(cache.at_or_after(frame)), frame);
    EXPECT_EQ(index_of(cache.at_or_after(30)), -1);
    EXPECT_TRUE(notes_.seeks.empty());
    EXPECT_EQ(notes_.decoded, 30);
}

TEST_F(FrameCacheTest, steps_back_over_what_it_holds_without_decoding) {
    FrameCache cache = cache_of(30);
    for (int frame = 0; frame < 30; ++frame) cache.at_or_after(frame);
    for (int frame = 29; frame >= 0; --frame) ASSERT_EQ(index_of(cache.at_or_after(frame)), frame);
    EXPECT_EQ(notes_.decoded, 30);
}

TEST_F(FrameCacheTest, decodes_a_run_for_the_steps_back_that_follow) {
    FrameCache cache = cache_of(300);
    EXPECT_EQ(index_of(cache.at_or_after(299)), 299);
    for (int frame = 298; frame > 200; --frame) ASSERT_EQ(index_of(cache.at_or_after(frame)), frame);
    EXPECT_LE(notes_.seeks.size(), 10U);
    EXPECT_LE(notes_.decoded, 120);
}

TEST_F(FrameCacheTest, keeps_what_was_used_last) {
    FrameCache cache = cache_of(100, {}, 8);
    EXPECT_EQ(cache.capacity(), 8U);
    for (int frame = 0; frame < 8; ++frame) cache.at_or_after(frame);
    cache.at_or_after(0);
    cache.at_or_after(8);  // in the place of frame 1
    const int decoded = notes_.decoded;
    EXPECT_EQ(index_of(cache.at_or_after(0)), 0);
    EXPECT_EQ(notes_.decoded, decoded);
    EXPECT_EQ(index_of(cache.at_or_after(1)), 1);
    EXPECT_GT(notes_.decoded, decoded);
}

TEST_F(FrameCacheTest, holds_a_few_frames_of_any_size) {
    EXPECT_EQ(cache_of(3, {}, 0).capacity(), 4U);
}

TEST_F(FrameCacheTest, passes_over_damaged_frames_both_ways) {
    FrameCache cache = cache_of(10, {0, 4, 5, 9});
    EXPECT_EQ(index_of(cache.at_or_after(0)), 1);
    EXPECT_EQ(index_of(cache.at_or_after(4)), 6);
    EXPECT_EQ(index_of(cache.before(6)), 3);
    EXPECT_EQ(index_of(cache.at_or_after(9)), -1);
    EXPECT_EQ(index_of(cache.before(10)), 8);
    EXPECT_EQ(index_of(cache.before(1)), -1);
}

TEST_F(FrameCacheTest, finds_the_last_frame_of_footage_that_ends_early) {
    FrameCache cache = cache_of(60, {50, 51, 52, 53, 54, 55, 56, 57, 58, 59});
    EXPECT_EQ(index_of(cache.at_or_after(59)), -1);
    EXPECT_EQ(index_of(cache.before(60)), 49);
}

}  // namespace
}  // namespace matchlight
