// The layers of `matchlight render` as other programs read them: put together again, they are the picture.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include "core/transfer.h"
#include "media/image_io.h"
#include "run_matchlight.h"
#include "tracking/solve_file.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;

/// The parts of a file, by name, as any program built on OpenImageIO has them.
class Layers {
public:
    explicit Layers(const fs::path& file) {
        for (int part = 0;; ++part) {
            OIIO::ImageBuf image(file.string(), part, 0);
            if (!image.read(part, 0, true, OIIO::TypeFloat)) break;
            parts_[image.spec().get_string_attribute("oiio:subimagename").c_str()] = std::move(image);
        }
        // A part that was asked for and is not there.
        OIIO::geterror();
    }
    const OIIO::ImageBuf& operator[](const std::string& name) const { return parts_.at(name); }
    std::string text(const std::string& part, const std::string& key) const {
        return std::string(parts_.at(part).spec().get_string_attribute(key));
    }
    /// The light channels of a part.
    OIIO::ImageBuf light(const std::string& name) const {
        return OIIO::ImageBufAlgo::channels(parts_.at(name), 3, {0, 1, 2});
    }
    /// plate · shadow · (1 − coverage) + reflection + virtual + spill + grain
    OIIO::ImageBuf together() const {
        namespace Algorithm = OIIO::ImageBufAlgo;
        // Where a part's window ends its pixels are 0, as the format has it.
        const OIIO::ImageBuf real = Algorithm::mul(light("plate"), light("shadow"));
        const OIIO::ImageBuf behind = Algorithm::sub(real, Algorithm::mul(real, light("coverage")));
        const OIIO::ImageBuf real_and_mirrored = Algorithm::add(behind, light("reflection"));
        return Algorithm::add(Algorithm::add(real_and_mirrored, light("virtual")),
                              Algorithm::add(light("spill"), light("grain")));
    }

private:
    std::map<std::string, OIIO::ImageBuf> parts_;
};

class ExrLayers : public CommandTest {
protected:
    void SetUp() override {
        shot_ = scratch_.copy_sample("table");
        scene_ = shot_ / "table.toml";
        ASSERT_TRUE(succeeded(run_matchlight({"track", scene_})));
    }
    fs::path render(const std::string& pattern, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> call{"render",   scene_, "-o",      scratch_ / pattern,
                                      "--frames", "6-6",  "--level", "draft"};
        call.insert(call.end(), more.begin(), more.end());
        EXPECT_TRUE(succeeded(run_matchlight(call)));
        return numbered(scratch_ / pattern, 6);
    }
    /// The picture that the layers make, and the one that the program makes of itself.
    void expect_same_picture() const {
        const Layers layers(render("out_%03d.exr"));
        const Image8 picture = read_rgb8(render("out_%03d.png"));
        const OIIO::ImageBuf together = layers.together();
        // The picture is rounded to whole codes. The layers are half floats, 11 bits of a value: four of them meet in
        // a pixel, each off by up to 2^-12 of light that an object can send brighter than white: a tenth of a code.
        constexpr double half_floats = 0.1;
        double worst = 0;
        for (int y = 0; y < picture.height(); ++y) {
            for (int x = 0; x < picture.width(); ++x) {
                for (int c = 0; c < 3; ++c) {
                    const double light = together.getchannel(x, y, 0, c);
                    const double code = 255 * std::clamp(srgb_code_from_linear(light), 0.0, 1.0);
                    worst = std::max(worst, std::abs(code - picture.at(x, y, c)));
                }
            }
        }
        EXPECT_LE(worst, 0.5 + half_floats);
    }

    fs::path shot_;
    fs::path scene_;
};

TEST_F(ExrLayers, MakeThePictureAgain) {
    expect_same_picture();
}

TEST_F(ExrLayers, MakeThePictureAgainWithEveryEffect) {
    std::ofstream(scene_, std::ios::app)
        << "[effects]\nbloom = {strength = 0.4}\nglare = {strength = 0.2}\ngrain = {read = 0.004, shot = 1e-3}\n"
           "vignette = {v1 = -0.2, v2 = 0.05}\nchromatic_aberration = {red_px = 1.5, blue_px = -1}\n"
           "depth_of_field = {focus_distance_m = 0.5, coc_scale_px_m = 3}\n";
    expect_same_picture();
    const Layers layers(render("effects_%03d.exr"));
    for (const char* part : {"spill", "grain"}) {
        const OIIO::ImageBufAlgo::PixelStats stats = OIIO::ImageBufAlgo::computePixelStats(layers[part]);
        EXPECT_GT(stats.max[1], 1e-3F) << part << " is there to be put back";
    }
}

TEST_F(ExrLayers, MakeThePictureAgainWithAShinyTable) {
    std::ofstream(scene_, std::ios::app) << "[quality]\nreflections = \"rays\"\nbounce = false\n"
                                            "[effects]\nvignette = {v1 = -0.2, v2 = 0.05}\n";
    std::string text = bytes_of(scene_);
    text.insert(text.find("[surface]\n") + 10, "reflection = 0.3\nreflection_roughness = 0.1\n");
    std::ofstream(scene_) << text;
    expect_same_picture();
    const Layers layers(render("shiny_%03d.exr"));
    const OIIO::ImageBufAlgo::PixelStats stats = OIIO::ImageBufAlgo::computePixelStats(layers["reflection"]);
    EXPECT_GT(stats.max[1], 0.01F) << "objects' light is put on";
    EXPECT_LT(stats.min[1], -0.01F) << "and the plate's is taken off";
}

TEST_F(ExrLayers, GoOnBeyondTheFrame) {
    std::ofstream(scene_, std::ios::app)
        << "[effects]\nbloom = {strength = 0.4}\nvignette = {v1 = -0.2, v2 = 0.05}\n"
           "chromatic_aberration = {red_px = 1.5, blue_px = -1}\n"
           "[[object]]\nshape = \"box\"\nscale = [2, 0.05, 0.05]\ntranslate = [0, 0.2, 0.03]\n";
    const Layers frame(render("frame_%03d.exr"));
    const Layers wide(render("wide_%03d.exr", {"--overscan", "10%"}));
    const OIIO::ImageSpec& spec = wide["beauty"].spec();
    EXPECT_EQ(OIIO::get_roi_full(spec), OIIO::ROI(0, 640, 0, 360, 0, 1, 0, 3)) << "the display window is the frame";
    EXPECT_EQ(OIIO::get_roi(spec), OIIO::ROI(-64, 704, -36, 396, 0, 1, 0, 3));
    // In the middle, where no light of what is beyond the frame comes in: sums over its pixels.
    std::map<std::string, double> sum, wide_sum, difference;
    double most_beside = 0, formula = 0;
    const OIIO::ImageBuf together = wide.together();
    for (int y = -36; y < 396; ++y) {
        for (int x = -64; x < 704; ++x) {
            for (int c = 0; c < 3; ++c) {
                const double seen = wide["beauty"].getchannel(x, y, 0, c);
                // Half floats: four of them, each off by 2^-12 of itself.
                formula = std::max(formula, std::abs(together.getchannel(x, y, 0, c) - seen) / std::max(seen, 1.0));
                if (x < 0 || y < 0 || x >= 640 || y >= 360) {
                    most_beside = std::max<double>(most_beside, wide["virtual"].getchannel(x, y, 0, 3));
                    EXPECT_EQ(wide["plate"].getchannel(x, y, 0, c), 0);
                } else if (x >= 160 && x < 480 && y >= 90 && y < 270) {
                    for (const char* part : {"beauty", "plate", "shadow", "virtual", "spill"}) {
                        const double before = frame[part].getchannel(x, y, 0, c);
                        sum[part] += before;
                        wide_sum[part] += wide[part].getchannel(x, y, 0, c);
                        difference[part] += std::abs(wide[part].getchannel(x, y, 0, c) - before);
                    }
                }
            }
        }
    }
    EXPECT_EQ(most_beside, 1) << "the bar goes on";
    EXPECT_LT(formula, 2e-3);
    EXPECT_EQ(difference["plate"], 0);
    EXPECT_EQ(difference["shadow"], 0);
    // A sample on an edge may fall on the other side of it.
    EXPECT_LT(difference["virtual"], 1e-3 * sum["virtual"]);
    // Bloom's coarse grids begin elsewhere: it is shifted by parts of their texels, and as much.
    EXPECT_NEAR(wide_sum["spill"], sum["spill"], 0.01 * sum["spill"]);
    EXPECT_GT(sum["spill"], 100);
    const std::string video = scratch_ / "out.mp4";
    EXPECT_TRUE(
        failed_naming(run_matchlight({"render", scene_, "-o", video, "--overscan", "5%"}), {video, "overscan"}));
    for (const char* wrong : {"-1", "nan", "200%", "3.5px", "5 %", ""})
        EXPECT_EQ(run_matchlight({"render", scene_, "-o", "x_%03d.exr", "--overscan", wrong}).status, 2) << wrong;
}

TEST_F(ExrLayers, SayWhatTheirNumbersMean) {
    // Shots begin at 1001: frame 6 of the clip is 1007, in the name and in the file.
    render("out_%04d.exr", {"--first", "1001"});
    EXPECT_FALSE(fs::exists(scratch_ / "out_0006.exr"));
    const Layers layers(scratch_ / "out_1007.exr");
    const Solve solve = load_solve(shot_ / "table.solve.json");
    const SolvedFrame& frame = *solve.find(6);
    for (const char* part : {"beauty", "plate", "virtual", "reflection", "spill", "grain"}) {
        EXPECT_EQ(layers.text(part, "matchlight:light"), "camera-linear") << part;
        EXPECT_EQ(layers.text(part, "matchlight:frame"), "1007");
        EXPECT_EQ(layers.text(part, "matchlight:scene"), "table.toml");
        const double ev = std::stod(layers.text(part, "matchlight:exposure_ev"));
        EXPECT_NEAR(ev, *frame.exposure_ev, 1e-6);
        std::istringstream balance(layers.text(part, "matchlight:white_balance"));
        std::istringstream gain(layers.text(part, "matchlight:gain_from_probe"));
        for (const double channel : *frame.white_balance) {
            double told = 0, factor = 0;
            ASSERT_TRUE(balance >> told && gain >> factor);
            EXPECT_NEAR(told, channel, 1e-6);
            EXPECT_NEAR(factor, std::exp2(ev) * told, 1e-6);
        }
        const OIIO::ParamValue* primaries = layers[part].spec().find_attribute("chromaticities");
        ASSERT_NE(primaries, nullptr) << part;
        EXPECT_FLOAT_EQ(primaries->get_float_indexed(0), 0.64F);
        EXPECT_FLOAT_EQ(primaries->get_float_indexed(7), 0.329F);
    }
    EXPECT_EQ(layers.text("beauty", "matchlight:response"), "\"srgb\"");
    for (const char* part : {"alpha", "shadow", "coverage", "depth", "normal", "object_id"}) {
        EXPECT_EQ(layers.text(part, "matchlight:light"), "") << part;
        EXPECT_NE(layers.text(part, "matchlight:unit"), "") << part;
    }
}

}  // namespace
}  // namespace matchlight::test
