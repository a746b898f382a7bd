// Autofocus and the focus of single objects, as a user asks for them.
#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "media/image_io.h"
#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;

class AutofocusTest : public CommandTest {
protected:
    /// From (0, −2, 0) along +y: a cube whose front is 1 m away to the left, one at 2.75 m in the middle, one at 4.5 m.
    fs::path scene(const std::string& effects, const std::string& near_focus = "", const std::string& focus = "") {
        const auto cube = [](const std::string& name, const std::string& place, const std::string& more) {
            return "[[object]]\nshape = \"box\"\nname = \"" + name + "\"\nscale = 0.5\ntranslate = " + place +
                   "\nmaterial = {emissive = [0.9, 0.5, 0.1]}\n" + more + "\n";
        };
        const fs::path path = scratch_ / ("scene" + std::to_string(++scenes_) + ".toml");
        std::ofstream(path) << "[camera]\nwidth = 80\nheight = 64\nvertical_fov_deg = 50\n"
                               "keys = [{frame = 0, eye = [0, -2, 0], target = [0, 0, 0]}]\n"
                               "lens = {f_number = 0.5, focus_distance_m = 1.5}\n"
                               "[background]\ncolor = [0, 0.1, 0.3]\n"
                            << cube("near", "[-0.45, -0.75, 0]", near_focus) << cube("middle", "[0, 1, 0]", focus)
                            << cube("far", "[1, 2.75, 0.5]", focus) << "[effects]\n"
                            << effects << "\n";
        return path;
    }
    fs::path focused(const std::string& how) {
        return scene("depth_of_field = {level = \"lens_samples\", lens_samples = 6, " + how + "}");
    }
    RunResult render_to(const fs::path& scene, Image8& picture) {
        const fs::path output = scratch_ / ("out" + std::to_string(scenes_) + "_%d.png");
        const RunResult result = run_matchlight({"render", scene, "-o", output, "--level", "draft"});
        if (result.status == 0) picture = read_rgb8(scratch_ / ("out" + std::to_string(scenes_) + "_0.png"));
        return result;
    }
    Image8 picture_of(const fs::path& scene) {
        Image8 picture;
        EXPECT_TRUE(succeeded(render_to(scene, picture)));
        return picture;
    }

    int scenes_ = 0;
};

int largest_difference(const Image8& a, const Image8& b) {
    int largest = 0;
    for (int y = 0; y < a.height(); ++y) {
        for (int x = 0; x < a.width(); ++x) {
            for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(a.at(x, y, c) - b.at(x, y, c)));
        }
    }
    return largest;
}

TEST_F(AutofocusTest, FocusesOnMiddleObjectAndPoint) {
    const Image8 as_given = picture_of(focused("focus_on = \"distance\""));
    const Image8 at_middle = picture_of(focused("focus_distance_m = 2.75"));
    const Image8 at_near = picture_of(focused("focus_distance_m = 1"));
    EXPECT_GT(largest_difference(as_given, at_middle), 20);
    EXPECT_GT(largest_difference(as_given, at_near), 20);
    // A focus of 2.75 m and one of 2.75 m found by a ray differ by rounding.
    EXPECT_LE(largest_difference(picture_of(focused("focus_on = \"middle\"")), at_middle), 1);
    EXPECT_LE(largest_difference(picture_of(focused("focus_on = \"object\", object = \"middle\"")), at_middle), 1);
    EXPECT_LE(largest_difference(picture_of(focused("focus_on = \"object\", object = \"near\"")), at_near), 1);
    EXPECT_LE(largest_difference(picture_of(focused("focus_on = \"point\", point = [3, -1, 7]")), at_near), 1);
}

TEST_F(AutofocusTest, KeepsItsDistanceWhereThereIsNothingToFocusOn) {
    const Image8 as_given = picture_of(focused("focus_on = \"distance\""));
    Image8 behind;
    const RunResult result = render_to(focused("focus_on = \"point\", point = [0, -3, 0]"), behind);
    ASSERT_TRUE(succeeded(result));
    EXPECT_TRUE(warned_of(result, {"focus_on", "behind the camera"}));
    EXPECT_EQ(largest_difference(behind, as_given), 0);
}

TEST_F(AutofocusTest, AnObjectsOwnFocusHoldsForItAlone) {
    const std::string effects = "depth_of_field = {level = \"lens_samples\", lens_samples = 6}";
    const Image8 off = picture_of(scene(""));
    const Image8 on = picture_of(scene(effects));
    const Image8 near_sharp = picture_of(scene(effects, "focus = \"sharp\""));
    const auto part = [](const Image8& picture, int from, int to) {
        Image8 columns(to - from, picture.height(), 3);
        for (int y = 0; y < columns.height(); ++y) {
            std::copy_n(picture.pixel(from, y), 3 * static_cast<std::size_t>(columns.width()), columns.pixel(0, y));
        }
        return columns;
    };
    // The near cube's left edge, at column 40 − 68.6·0.7/1 < 0, is out of the picture: its top and bottom edges are in.
    EXPECT_GT(largest_difference(part(on, 0, 20), part(off, 0, 20)), 20);
    EXPECT_LE(largest_difference(part(near_sharp, 0, 20), part(off, 0, 20)), 1);
    EXPECT_LE(largest_difference(part(near_sharp, 55, 80), part(on, 55, 80)), 1);
    // At 1 m, as if the lens were focused there: its front is sharp.
    const Image8 near_at_1m = picture_of(scene(effects, "focus = 1.0"));
    EXPECT_LT(largest_difference(part(near_at_1m, 0, 12), part(off, 0, 12)),
              largest_difference(part(on, 0, 12), part(off, 0, 12)));
    // Where nothing is blurred at all the effect is left out.
    EXPECT_EQ(largest_difference(picture_of(scene(effects, "focus = \"sharp\"", "focus = \"sharp\"")), off), 0);
    // By methods that blur one picture, too.
    for (const char* level : {"gather", "two_pass", "layers"}) {
        const std::string blurred = "depth_of_field = {level = \"" + std::string(level) + "\"}";
        const Image8 sharp = picture_of(scene(blurred, "focus = \"sharp\""));
        EXPECT_LE(largest_difference(part(sharp, 0, 20), part(off, 0, 20)), 1) << level;
        EXPECT_GT(largest_difference(part(sharp, 55, 80), part(off, 55, 80)), 20) << level;
    }
}

}  // namespace
}  // namespace matchlight::test
