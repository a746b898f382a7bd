// Mattes and depths that come with the footage put the real before the virtual.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <fmt/format.h>
#include <unistd.h>

#include "compositor_shot.h"
#include "media/image_io.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;

class SideFootage : public CompositorTest {
protected:
    SideFootage() {
        shot_.solve.frame_count = 1;
        folder_ = fs::temp_directory_path() / fmt::format("matchlight_side_{}", getpid());
        fs::create_directories(folder_);
    }
    ~SideFootage() override { fs::remove_all(folder_); }

    using Value = std::function<double(double x, double y)>;
    void set_matte(const Value& share) {
        Image16 picture(320, 180, 1);
        for (int y = 0; y < 180; ++y) {
            for (int x = 0; x < 320; ++x)
                picture.at(x, y) = static_cast<std::uint16_t>(std::lround(65535 * share(x, y)));
        }
        shot_.scene.footage.matte = folder_ / "matte_%03d.png";
        write_png16(numbered(shot_.scene.footage.matte, 0), picture);
    }
    void set_depth(const Value& depth_m) {
        ImageF picture(320, 180, 1);
        for (int y = 0; y < 180; ++y) {
            for (int x = 0; x < 320; ++x) picture.at(x, y) = static_cast<float>(depth_m(x, y));
        }
        shot_.scene.footage.depth = folder_ / "depth_%03d.exr";
        write_exr(numbered(shot_.scene.footage.depth, 0), 320, 180, {{"", {"Z"}, &picture, false, {}}}, {});
    }
    static bool same(const CompositedFrame& one, const CompositedFrame& other) {
        return std::ranges::equal(one.rgb16().samples(), other.rgb16().samples());
    }
    static bool is_plate(const CompositedFrame& frame) {
        return std::ranges::equal(frame.rgb16().samples(), frame.plate.rgb16({0, 0, 320, 180}).samples());
    }
    FrameLayers layers(const Quality& quality) {
        Warnings warnings;
        warnings.set_quiet(true);
        Compositor compositor(context(), shot_.scene, shot_.solve, {.settings = quality, .layers = true}, warnings);
        CompositedFrame frame = compositor.composite(grey_plate(320, 180, plate_luma_));
        return std::move(*frame.layers);
    }

    fs::path folder_;
    Shot shot_ = make_shot();
};

TEST_F(SideFootage, AWhiteMatteLeavesThePlateAndABlackOneThePicture) {
    const CompositedFrame without = composite(shot_, true);
    ASSERT_FALSE(is_plate(without));
    set_matte([](double, double) { return 1; });
    EXPECT_TRUE(is_plate(composite(shot_, true)));
    set_matte([](double, double) { return 0; });
    EXPECT_TRUE(same(composite(shot_, true), without));
}

TEST_F(SideFootage, AGreyMatteLeavesItsShareOfEveryLayer) {
    const Quality quality = quality_of(QualityLevel::draft);
    const FrameLayers without = layers(quality);
    constexpr double share = 0.25;
    set_matte([](double, double) { return share; });
    const FrameLayers with = layers(quality);
    ASSERT_EQ(with.region, without.region);
    double worst = 0;
    for (int y = 0; y < with.region.height; ++y) {
        for (int x = 0; x < with.region.width; ++x) {
            worst = std::max(worst, std::abs(with.alpha.at(x, y) - (1 - share) * without.alpha.at(x, y)));
            for (int c = 0; c < 3; ++c) {
                const double lost = 1 - without.shadow.at(x, y, c);
                worst = std::max(worst, std::abs(1 - with.shadow.at(x, y, c) - (1 - share) * lost));
                const double light = without.virtual_rgba.at(x, y, c);
                worst = std::max(worst, std::abs(with.virtual_rgba.at(x, y, c) - (1 - share) * light) / (1 + light));
            }
        }
    }
    EXPECT_LT(worst, 2e-5) << "16 bits of the matte";
}

TEST_F(SideFootage, WhatIsNearerHidesAndWhatIsFartherOrUnknownDoesNot) {
    shot_.scene.surface.shadow = false;
    const CompositedFrame without = composite(shot_, true);
    set_depth([](double, double) { return 0.2; });
    EXPECT_TRUE(is_plate(composite(shot_, true)));
    set_depth([](double, double) { return 5; });
    EXPECT_TRUE(same(composite(shot_, true), without));
    set_depth([](double, double) { return 0; });
    EXPECT_TRUE(same(composite(shot_, true), without));
}

TEST_F(SideFootage, DepthsThatAreNoneCountAsUnknownAndAreToldOf) {
    shot_.scene.surface.shadow = false;
    const CompositedFrame without = composite(shot_, true);
    set_depth([](double x, double) { return x < 160 ? std::numeric_limits<double>::quiet_NaN() : -1; });
    Warnings warnings;
    warnings.set_quiet(true);
    Compositor compositor(context(), shot_.scene, shot_.solve, {.quality = shot_.scene.quality}, warnings);
    EXPECT_TRUE(same(compositor.composite(grey_plate(320, 180, plate_luma_)), without));
    EXPECT_EQ(std::ranges::count_if(warnings.entries(),
                                    [](const Warnings::Entry& entry) {
                                        return entry.text.find("count as unknown") != std::string::npos;
                                    }),
              2);
}

TEST_F(SideFootage, AnEdgeInDepthRunsStraightBetweenThePixels) {
    // A near half plane with a slanted side: pixels left of it are at 0.2 m, the others unknown.
    shot_.scene.surface.shadow = false;
    shot_.scene.objects[0].scale.setConstant(0.12);
    const Quality quality = quality_of(QualityLevel::final_);
    const auto edge_x = [](double y) { return 159.3 + 0.21 * (y - 90); };
    const FrameLayers without = layers(quality);
    set_depth([&](double x, double y) { return x < edge_x(y) ? 0.2 : 0; });
    const FrameLayers with = layers(quality);
    double worst = 0;
    int rows = 0, partly = 0;
    for (int y = 0; y < with.region.height; ++y) {
        // Inside of the ball, where everything was covered: the covered length tells where the edge is.
        double covered = 0, before = 0;
        for (int x = 0; x < with.region.width; ++x) {
            if (std::abs(with.region.x + x - edge_x(with.region.y + y)) > 6) continue;
            before += without.alpha.at(x, y);
            covered += with.alpha.at(x, y);
            partly += with.alpha.at(x, y) > 0.05F && with.alpha.at(x, y) < 0.95F;
        }
        if (before < 11.9) continue;
        ++rows;
        // Pixels end half a pixel beside their middle.
        double right_end = 0;
        for (int x = 0; x < with.region.width; ++x) {
            if (std::abs(with.region.x + x - edge_x(with.region.y + y)) <= 6) right_end = with.region.x + x + 0.5;
        }
        worst = std::max(worst, std::abs(right_end - covered - edge_x(with.region.y + y)));
    }
    ASSERT_GT(rows, 10);
    // Which pixels are near is known to a whole pixel: half of one on either side of the line.
    EXPECT_LT(worst, 0.75);
    EXPECT_GT(partly, rows / 2) << "antialiased";
}

TEST_F(SideFootage, TheBlurOfWhatIsBehindDoesNotSpreadOverWhatIsNear) {
    shot_.scene.surface.shadow = false;
    shot_.scene.objects[0].translate_m = {0, 0.2, 0.05};
    shot_.scene.objects[0].scale.setConstant(0.12);
    DepthOfFieldSettings blur;
    blur.focus_distance_m = 0.4;
    blur.coc_scale_px_m = 20;
    blur.level = DepthOfFieldLevel::gather;
    shot_.scene.effects.depth_of_field = blur;
    // In focus, so that its edge is sharp.
    set_depth([](double x, double) { return x < 160 ? 0.4 : 0; });
    const FrameLayers with = layers(quality_of(QualityLevel::final_));
    int seen = 0;
    for (int y = 0; y < with.region.height; ++y) {
        for (int x = 0; x < with.region.width; ++x) {
            seen += with.alpha.at(x, y) > 0.5F;
            if (with.region.x + x < 158) {
                EXPECT_LT(with.alpha.at(x, y), 0.02F) << x << " " << y;
            }
        }
    }
    EXPECT_GT(seen, 300);
}

}  // namespace
}  // namespace matchlight::test
