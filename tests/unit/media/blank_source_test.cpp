// Frames without footage: black, of any size, in any order.
#include "media/blank_source.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace matchlight {
namespace {

TEST(BlankSource, GivesBlackFramesWithTheirTimes) {
    for (const auto& [width, height] : {std::pair(1, 1), {7, 5}, {800, 600}}) {
        BlankSource source({.path = "scene.toml", .width = width, .height = height, .frames = 3, .fps = 30});
        EXPECT_EQ(source.info().frame_count, 3);
        EXPECT_EQ(source.info().frame_rate.numerator, 30);
        for (int i = 0; i < 3; ++i) {
            const std::optional<PlateFrame> frame = source.next();
            ASSERT_TRUE(frame);
            EXPECT_EQ(frame->index(), i);
            EXPECT_DOUBLE_EQ(frame->time_s(), i / 30.0);
            EXPECT_EQ(frame->format().width, width);
            EXPECT_EQ(frame->format().height, height);
            const Image8 rgb = frame->rgb8({0, 0, width, height});
            for (const std::uint8_t sample : rgb.samples()) ASSERT_EQ(sample, 0);
        }
        EXPECT_FALSE(source.next());
        source.seek(1);
        EXPECT_EQ(source.next()->index(), 1);
    }
}

TEST(BlankSource, KeepsWhatIsWrittenOnOneFrameFromTheOthers) {
    BlankSource source({.path = "scene.toml", .width = 4, .height = 4, .frames = 2, .fps = 25});
    PlateFrame first = *source.next();
    const Region all{0, 0, 4, 4};
    first.write_rgb_code(all, ImageF(4, 4, 3, 1.0F), Image8(4, 4, 1, 255));
    EXPECT_EQ(first.rgb8(all).at(1, 1), 255);
    EXPECT_EQ(source.next()->rgb8(all).at(1, 1), 0);
}

TEST(BlankSource, RefusesSizesBeyondTheLimits) {
    EXPECT_THROW(BlankSource({.path = "scene.toml", .width = 1 << 20, .height = 4, .frames = 1, .fps = 25}),
                 InputError);
}

}  // namespace
}  // namespace matchlight
