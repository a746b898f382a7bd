// Glass before footage: what it shows of the plate and of virtual things behind it.
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

class Glass : public test::BallAndBox {
protected:
    void SetUp() override {
        set_up(320, 180);
        folder_ = std::filesystem::temp_directory_path() / ("matchlight-glass-" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
        // Between the camera and the ball.
        scene_.objects[1].shape.clear();
        scene_.objects[1].translate_m = {-0.045, -0.12, 0.14};
        scene_.objects[1].scale.setConstant(0.1);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    void set_box(const nlohmann::json& material) {
        const std::filesystem::path file = folder_ / "glass.glb";
        test::BoxMotion box;
        box.material = material;
        std::ofstream(file, std::ios::binary) << test::box_glb(box);
        scene_.objects[1].model = file;
    }
    /// Lets everything through that base colour lets, and mirrors nothing.
    static nlohmann::json clear(const std::vector<double>& base_color) {
        return {
            {"pbrMetallicRoughness", {{"baseColorFactor", base_color}, {"metallicFactor", 0}, {"roughnessFactor", 0}}},
            {"extensions",
             {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
              {"KHR_materials_specular", {{"specularFactor", 0}}}}}};
    }
    CompositedFrame composite(const Scene& scene) {
        CompositorOptions with;
        with.settings = without_rays(coarse_quality());
        Compositor compositor(context(), scene, solve_, with, warnings_);
        return compositor.composite(plate(0));
    }

    std::filesystem::path folder_;
};

TEST_F(Glass, ThatNeitherMirrorsNorTintsIsNotSeen) {
    scene_.objects[1].casts_shadow = false;
    for (const bool shadow : {false, true}) {
        scene_.surface.shadow = shadow;
        set_box(clear({1, 1, 1, 1}));
        const Image16 with = composite(scene_).rgb16();
        // In the same picture: a box that is cut out whole.
        set_box({{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0}}}}, {"alphaMode", "MASK"}});
        const Image16 without = composite(scene_).rgb16();
        double worst = 0, sum = 0;
        for (std::size_t i = 0; i < with.samples().size(); ++i) {
            const double off = std::abs(with.samples()[i] / 65535.0 - without.samples()[i] / 65535.0);
            worst = std::max(worst, off);
            sum += off;
        }
        // Half floats. The hard edges of a coarse shadow are looked up at other points than without glass.
        if (!shadow) {
            EXPECT_LT(worst, 2.0 / 255);
        }
        EXPECT_LT(sum / static_cast<double>(with.samples().size()), 2e-4);
    }
}

TEST_F(Glass, TintsThePlateInLinearLight) {
    scene_.objects[0].translate_m.y() = 5;  // away
    set_box(clear({0.5, 1, 0.25, 1}));
    const CompositedFrame frame = composite(scene_);
    const auto picture = frame.rgb16();
    const auto linear = [](double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); };
    // Where the least green differs from its red the box is; all of it is of one colour.
    double least_red = 1, least_blue = 1;
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) {
            least_red = std::min(least_red, picture.at(x, y, 0) / 65535.0);
            least_blue = std::min(least_blue, picture.at(x, y, 2) / 65535.0);
        }
    }
    const double plate = linear(picture.at(2, 2, 1) / 65535.0);
    EXPECT_NEAR(linear(least_red) / plate, 0.5, 0.02) << "the response is sRGB, to a code";
    EXPECT_NEAR(linear(least_blue) / plate, 0.25, 0.02);
}

}  // namespace
}  // namespace matchlight
