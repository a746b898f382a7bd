// Ranges, numbers and frame rates of what is exported.
#include "exchange/camera_track.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "exchange/camera_table.h"
#include "made_solve.h"

namespace matchlight::test {
namespace {

std::vector<SolvedFrame> frames_at(double fps, int count, double rounding_s) {
    std::vector<SolvedFrame> frames(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        frames[static_cast<std::size_t>(i)].frame = i;
        const double time_s = i / fps;
        frames[static_cast<std::size_t>(i)].time_s =
            rounding_s > 0 ? std::round(time_s / rounding_s) * rounding_s : time_s;
    }
    return frames;
}

TEST(CameraTrack, FrameRateIsTheUsualOneThatTheStampsMean) {
    for (const double rounding_s : {0.0, 1e-3, 1.0 / 90000}) {
        EXPECT_EQ(frame_rate(frames_at(24, 12, rounding_s)), 24.0);
        EXPECT_EQ(frame_rate(frames_at(60, 500, rounding_s)), 60.0);
        EXPECT_DOUBLE_EQ(*frame_rate(frames_at(30 / 1.001, 500, rounding_s)), 30 / 1.001);
        EXPECT_DOUBLE_EQ(*frame_rate(frames_at(24 / 1.001, 500, rounding_s)), 24 / 1.001);
    }
    EXPECT_NEAR(*frame_rate(frames_at(17.3, 500, 0)), 17.3, 1e-9);
    EXPECT_FALSE(frame_rate(frames_at(24, 1, 0)));
    EXPECT_FALSE(frame_rate(std::vector<SolvedFrame>(3)));  // all at 0
}

TEST(CameraTrack, VaryingRatesAreWarnedOfAndKeepTheirStamps) {
    Solve solve = made_solve();
    Warnings warnings;
    warnings.set_quiet(true);
    EXPECT_EQ(camera_track(solve, {}, "c", warnings).fps, 24);
    EXPECT_EQ(warnings.total(), 1);  // of the frames without a pose
    for (std::size_t i = 6; i < 10; ++i) solve.frames[i].time_s += 0.1;
    const CameraTrack track = camera_track(solve, {}, "c", warnings);
    EXPECT_EQ(warnings.entries().size(), 2u);
    EXPECT_EQ(track.frames[8].time_s, solve.frames[8].time_s);
    for (SolvedFrame& frame : solve.frames) frame.time_s = 0;
    const CameraTrack untimed = camera_track(solve, {}, "c", warnings);
    EXPECT_EQ(warnings.entries().size(), 3u);
    EXPECT_DOUBLE_EQ(untimed.frames[5].time_s, 0.2);  // 25 a second
}

TEST(CameraTrack, TakesTheRangeAndNumbersIt) {
    CameraTrackOptions options;
    options.first_frame = 3;
    options.last_frame = 6;
    options.first_number = 1001;
    options.fps = 50;
    const CameraTrack track = track_of(made_solve(), options);
    ASSERT_EQ(track.frames.size(), 4u);
    EXPECT_EQ(track.posed(), 2);
    EXPECT_EQ(track.frames[0].frame, 1004);
    EXPECT_EQ(track.frames[0].time_s, 0.06);
    EXPECT_EQ(track.fps, 50);
    options.first_frame = 4;
    options.last_frame = 5;  // the two without a pose
    EXPECT_THROW(track_of(made_solve(), options), InputError);
}

TEST(CameraTable, HoldsALineAFrameAndGapsWhereNothingIsKnown) {
    const std::string text = camera_table_csv(track_of(made_solve()));
    std::vector<std::string> lines;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = text.find("\r\n", at);
        lines.push_back(text.substr(at, end - at));
        at = end + 2;
    }
    ASSERT_EQ(lines.size(), 11u);
    for (const std::string& line : lines) EXPECT_EQ(std::ranges::count(line, ','), 22) << line;
    EXPECT_TRUE(lines[0].starts_with("frame,time_s,x_m,y_m,z_m,qw"));
    EXPECT_NE(lines[1].find(",0 7,-1,1.05,1,0.95,"), std::string::npos) << lines[1];
    EXPECT_EQ(lines[5].find_first_not_of(",", lines[5].find(",,")), std::string::npos) << lines[5];
    // Straight down from (0.1, 0, 0.6).
    EXPECT_TRUE(lines[3].starts_with("2,0.08333333333333333,0.1,")) << lines[3];
}

}  // namespace
}  // namespace matchlight::test
