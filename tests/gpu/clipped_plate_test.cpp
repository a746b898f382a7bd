// A clipped plate under a shadow: as bright as other frames know it, where they do, and flagged where they do not.
#include "compositor_shot.h"

namespace matchlight::test {
namespace {

constexpr std::uint8_t white_luma = 235;

/// A metre about the origin that sends out 3 in probe units: at the shot's exposure of −1 EV 1.5 times what clips.
std::shared_ptr<GatheredSurface> bright_surface() {
    auto gathered = std::make_shared<GatheredSurface>();
    gathered->radiance = ImageF(64, 64, 4, 3.0f);
    for (int i = 0; i < 64 * 64; ++i) gathered->radiance.pixel(i % 64, i / 64)[3] = 1;
    gathered->clipped = ImageF(64, 64, 1);
    gathered->rectangle_m = {Eigen::Vector2d(-0.5, -0.5), Eigen::Vector2d(0.5, 0.5)};
    return gathered;
}

class ClippedPlateTest : public CompositorTest {
protected:
    CompositedFrame composite_white(const std::shared_ptr<const GatheredSurface>& gathered, bool layers = true) {
        const Shot shot = make_shot();
        warnings_.set_quiet(true);
        Compositor compositor(context(), shot.scene, shot.solve,
                              {.quality = shot.scene.quality, .gathered_surface = gathered, .layers = layers},
                              warnings_);
        return compositor.composite(grey_plate(320, 180, white_luma));
    }

    /// Calls `body(light, ratio)` where there is shadow alone, the red channel.
    template <class Body>
    static int over_shadow(const FrameLayers& layers, const Body& body) {
        int pixels = 0;
        for (int y = 0; y < layers.beauty.height(); ++y) {
            for (int x = 0; x < layers.beauty.width(); ++x) {
                const float ratio = layers.shadow.at(x, y, 0);
                if (!(ratio < 0.6f) || layers.alpha.at(x, y) > 0) continue;
                body(layers.beauty.at(x, y, 0), ratio);
                ++pixels;
            }
        }
        return pixels;
    }

    Warnings warnings_;
};

TEST_F(ClippedPlateTest, takes_the_light_that_other_frames_know) {
    const CompositedFrame frame = composite_white(bright_surface());
    const int pixels = over_shadow(*frame.layers, [](float light, float ratio) {
        EXPECT_NEAR(light, 1.5f * ratio, 2e-3f * ratio);  // the texture of ratios holds halves
    });
    EXPECT_GT(pixels, 20);
    EXPECT_EQ(frame.clipped_under_shadow, 0);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(ClippedPlateTest, is_its_bound_and_flagged_where_no_frame_knows_better) {
    const CompositedFrame frame = composite_white(nullptr);
    EXPECT_GT(over_shadow(*frame.layers, [](float light, float ratio) { EXPECT_NEAR(light, ratio, 2e-3f * ratio); }),
              20);
    EXPECT_GT(frame.clipped_under_shadow, 20);
    EXPECT_FALSE(warnings_.empty());

    const auto bounded = bright_surface();
    std::ranges::fill(bounded->clipped.samples(), 1.0f);
    EXPECT_EQ(composite_white(bounded).clipped_under_shadow, frame.clipped_under_shadow) << "bounds in every frame";
}

TEST_F(ClippedPlateTest, leaves_what_nothing_touches_as_it_was) {
    const CompositedFrame known = composite_white(bright_surface(), false);
    const Image8 plate = grey_plate(320, 180, white_luma).rgb8({0, 0, 320, 180});
    const Image8 picture = known.rgb8();
    int untouched = 0;
    for (int y = 0; y < 180; ++y) {
        for (int x = 0; x < 320; ++x) {
            if (known.reach.contains(x, y) && known.touched.at(x - known.reach.x, y - known.reach.y) != 0) continue;
            ASSERT_TRUE(std::equal(picture.pixel(x, y), picture.pixel(x, y) + 3, plate.pixel(x, y))) << x << ' ' << y;
            ++untouched;
        }
    }
    EXPECT_GT(untouched, 320 * 180 / 2);
}

TEST_F(ClippedPlateTest, costs_a_plate_that_is_not_clipped_nothing) {
    const Shot shot = make_shot();
    Compositor with(context(), shot.scene, shot.solve,
                    {.quality = shot.scene.quality, .gathered_surface = bright_surface()}, warnings_);
    const CompositedFrame frame = with.composite(grey_plate(320, 180, 120));
    for (const PassReport& report : with.reports()) EXPECT_FALSE(report.name == "plate/unclipped" && report.drawn);
    EXPECT_EQ(frame.clipped_under_shadow, 0);
    EXPECT_TRUE(std::ranges::equal(frame.rgb16().samples(), composite(shot, true).rgb16().samples()));
}

}  // namespace
}  // namespace matchlight::test
