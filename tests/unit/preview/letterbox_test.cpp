// A picture keeps its shape in every window, and its samples where the window has its size.
#include "preview/letterbox.h"

#include <gtest/gtest.h>

namespace matchlight {
namespace {

TEST(Letterbox, is_the_window_where_sizes_agree) {
    EXPECT_EQ(letterbox({640, 360}, 640, 360), Eigen::Vector4f(0, 0, 640, 360));
    EXPECT_EQ(letterbox({1, 1}, 1, 1), Eigen::Vector4f(0, 0, 1, 1));
}

TEST(Letterbox, leaves_bars_on_two_sides_alike) {
    EXPECT_EQ(letterbox({640, 360}, 640, 480), Eigen::Vector4f(0, 60, 640, 360));
    EXPECT_EQ(letterbox({640, 360}, 1000, 360), Eigen::Vector4f(180, 0, 640, 360));
    EXPECT_EQ(letterbox({640, 360}, 320, 320), Eigen::Vector4f(0, 70, 320, 180));
    EXPECT_EQ(letterbox({7, 5}, 71, 50), Eigen::Vector4f(0, 0, 70, 50));
}

TEST(Letterbox, shows_at_least_a_pixel) {
    EXPECT_EQ(letterbox({10000, 1}, 100, 100), Eigen::Vector4f(0, 49, 100, 1));
}

TEST(Letterbox, stretches_pixels_that_are_not_square) {
    // PAL: 720×576 samples shown as 16:9 or nearly so.
    const PictureSize shown = displayed_size(720, 576, 64.0 / 45);
    EXPECT_EQ(shown.width, 1024);
    EXPECT_EQ(shown.height, 576);
}

TEST(FittedWindow, is_the_pictures_where_there_is_room) {
    EXPECT_EQ(fitted_window({640, 360}, {1152, 921}, {320, 240}), Eigen::Vector2i(640, 360));
}

TEST(FittedWindow, is_as_large_as_the_screen_allows) {
    EXPECT_EQ(fitted_window({8192, 4320}, {1024, 768}, {320, 240}), Eigen::Vector2i(1024, 540));
    EXPECT_EQ(fitted_window({1080, 1920}, {1920, 960}, {320, 240}), Eigen::Vector2i(540, 960));
}

TEST(FittedWindow, is_never_too_small_to_use) {
    EXPECT_EQ(fitted_window({1, 1}, {1024, 768}, {320, 240}), Eigen::Vector2i(320, 240));
}

}  // namespace
}  // namespace matchlight
