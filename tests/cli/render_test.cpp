// What `matchlight render` puts into a picture and what it leaves alone, on the sample shot.
#include <cmath>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "core/warnings.h"
#include "media/frame_source.h"
#include "media/image_io.h"
#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;

class RenderTest : public CommandTest {
protected:
    void SetUp() override {
        shot_ = scratch_.copy_sample("table");
        scene_ = shot_ / "table.toml";
        ASSERT_TRUE(succeeded(run_matchlight({"track", scene_})));
    }

    RunResult render(const fs::path& output, const std::vector<std::string>& more) const {
        std::vector<std::string> call{"render", scene_, "-o", output};
        call.insert(call.end(), more.begin(), more.end());
        return run_matchlight(call);
    }

    /// Writes a scene beside the first in which `from` reads `to`; it uses the same solve.
    void change_scene(const std::string& from, const std::string& to) {
        std::string text = bytes_of(scene_);
        const std::size_t at = text.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        text.replace(at, from.size(), to);
        std::ofstream(scene_, std::ios::binary | std::ios::trunc) << text;
    }

    /// The frames as decoded, without anything virtual in view.
    fs::path decoded_plate(const std::string& frames) {
        const std::string with_objects = bytes_of(scene_);
        change_scene("model = \"objects.glb\"", "translate = [0, 0, 500]\nmodel = \"objects.glb\"");
        change_scene("z = 0.0\n", "shadow = false\nz = 0.0\n");
        EXPECT_TRUE(succeeded(render(scratch_ / "plate_%03d.png", {"--frames", frames, "--level", "draft"})));
        std::ofstream(scene_, std::ios::binary | std::ios::trunc) << with_objects;
        return scratch_ / "plate_%03d.png";
    }

    fs::path shot_;
    fs::path scene_;
    Warnings warnings_;
};

TEST_F(RenderTest, PixelsThatNothingTouchesAreTheDecodedPlate) {
    const fs::path plate = decoded_plate("5-5");
    const fs::path output = scratch_ / "out_%03d.png";
    const fs::path masks = scratch_ / "touched_%03d.png";
    ASSERT_TRUE(succeeded(render(output, {"--frames", "5-5", "--touched", masks})));
    const Image8 before = read_rgb8(numbered(plate, 5));
    const Image8 after = read_rgb8(numbered(output, 5));
    const Image8 touched = read_mask(numbered(masks, 5));
    std::int64_t outside = 0, changed_inside = 0;
    for (int y = 0; y < before.height(); ++y) {
        for (int x = 0; x < before.width(); ++x) {
            const bool same = std::equal(before.pixel(x, y), before.pixel(x, y) + 3, after.pixel(x, y));
            if (touched.at(x, y) != 0) {
                changed_inside += same ? 0 : 1;
            } else {
                ++outside;
                ASSERT_TRUE(same) << x << ' ' << y;
            }
        }
    }
    EXPECT_GT(outside, before.width() * before.height() / 4);
    EXPECT_GT(changed_inside, 8000);  // three objects of about 70 px each
}

TEST_F(RenderTest, GrainIsTheSameInAnyChunkAndOnWhatIsTouchedAlone) {
    const std::string level = "draft";
    ASSERT_TRUE(succeeded(render(scratch_ / "plain_%03d.png", {"--frames", "5-6", "--level", level})));
    std::ofstream(scene_, std::ios::app) << "[effects]\ngrain = {strength = 3}\n";  // the solve's noise
    const fs::path masks = scratch_ / "touched_%03d.png";
    ASSERT_TRUE(
        succeeded(render(scratch_ / "both_%03d.png", {"--frames", "5-6", "--level", level, "--touched", masks})));
    ASSERT_TRUE(succeeded(render(scratch_ / "one_%03d.png", {"--frames", "6-6", "--level", level})));
    EXPECT_EQ(bytes_of(scratch_ / "both_006.png"), bytes_of(scratch_ / "one_006.png"));
    // What grain did to each frame: nothing outside of what is touched, and another noise in each.
    std::vector<std::vector<double>> noise(2);
    for (const int frame : {5, 6}) {
        const Image8 plain = read_rgb8(numbered(scratch_ / "plain_%03d.png", frame));
        const Image8 grainy = read_rgb8(numbered(scratch_ / "both_%03d.png", frame));
        const Image8 touched = read_mask(numbered(masks, frame));
        for (int y = 0; y < plain.height(); ++y) {
            for (int x = 0; x < plain.width(); ++x) {
                const double added = grainy.at(x, y, 1) - plain.at(x, y, 1);
                if (touched.at(x, y) == 0) {
                    ASSERT_EQ(added, 0) << x << ' ' << y;
                }
                noise[static_cast<std::size_t>(frame - 5)].push_back(added);
            }
        }
    }
    double squares = 0, products = 0;
    for (std::size_t i = 0; i < noise[0].size(); ++i) {
        squares += noise[0][i] * noise[0][i];
        products += noise[0][i] * noise[1][i];
    }
    EXPECT_GT(squares, 10'000) << "of thousands of pixels each moved by some codes";
    EXPECT_LT(std::abs(products), 0.1 * squares);
}

TEST_F(RenderTest, GrainOfUnknownNoiseIsSaidOnce) {
    std::string solve = bytes_of(shot_ / "table.solve.json");
    solve.replace(solve.find("\"noise\""), 7, "\"noises\"");
    std::ofstream(shot_ / "table.solve.json", std::ios::binary | std::ios::trunc) << solve;
    std::ofstream(scene_, std::ios::app) << "[effects]\ngrain = \"auto\"\nchromatic_aberration = \"auto\"\n";
    const RunResult run = render(scratch_ / "out_%03d.png", {"--frames", "5-5", "--level", "draft"});
    ASSERT_TRUE(succeeded(run));
    EXPECT_THAT(run.standard_error, testing::HasSubstr("the noise is not known"));
    EXPECT_THAT(run.standard_error, testing::HasSubstr("chromatic aberration is not known"));
}

TEST_F(RenderTest, MasksNeverReplaceWhatExists) {
    const fs::path output = scratch_ / "out_%03d.png";
    const std::vector<std::string> some{"--frames", "5-6", "--level", "draft", "--touched"};
    const auto refused = [&](const fs::path& masks, const std::string& why) {
        std::vector<std::string> call = some;
        call.push_back(masks);
        const RunResult run = render(output, call);
        EXPECT_EQ(run.status, 1) << masks;
        EXPECT_THAT(run.standard_error, testing::HasSubstr(why));
        EXPECT_FALSE(fs::exists(numbered(output, 5))) << "nothing is rendered before";
    };
    refused(scratch_ / "mask.png", "names one picture for all frames");
    refused(scratch_ / "mask_%03d.mp4", "PNG");
    refused(output, "name of the output");
    std::ofstream(scratch_ / "mask_006.png") << "here before";
    refused(scratch_ / "mask_%03d.png", "mask_006.png");
    EXPECT_EQ(bytes_of(scratch_ / "mask_006.png"), "here before");
}

TEST_F(RenderTest, ExplainSaysWhatBecameOfEachPass) {
    const RunResult run = run_matchlight({"render", scene_, "--explain", "6", "--level", "draft", "--json"});
    ASSERT_TRUE(succeeded(run));
    const auto report = nlohmann::json::parse(run.standard_output);
    EXPECT_EQ(report.at("frame"), 6);
    std::map<std::string, nlohmann::json> passes;
    for (const auto& pass : report.at("passes")) passes[pass.at("pass")] = pass;
    for (const char* drawn : {"plate/upload", "surface", "composite"}) {
        ASSERT_TRUE(passes.contains(drawn)) << drawn;
        EXPECT_TRUE(passes[drawn].at("drawn").get<bool>()) << drawn;
        EXPECT_GT(passes[drawn].at("ms").get<double>(), 0) << drawn;
        EXPECT_GT(passes[drawn].at("bytes").get<double>(), 0) << drawn;
        EXPECT_GT(passes[drawn].at("region").at("width").get<int>(), 0) << drawn;
    }
    for (const char* left_out : {"light/sphere map", "light/reflection cube", "shadow/contact", "bloom", "glare"}) {
        ASSERT_TRUE(passes.contains(left_out)) << left_out;
        EXPECT_FALSE(passes[left_out].at("drawn").get<bool>()) << left_out;
        EXPECT_NE(passes[left_out].at("why"), "") << left_out;
    }
    EXPECT_EQ(run_matchlight({"render", scene_, "--explain", "99"}).status, 1);
    EXPECT_EQ(run_matchlight({"render", scene_}).status, 2) << "neither output nor --explain";
    EXPECT_EQ(run_matchlight({"render", scene_, "--explain", "1", "-o", "x.mp4"}).status, 2);
}

TEST_F(RenderTest, LooksLikeTheTruth) {
    const fs::path plate = decoded_plate("0-11");
    ASSERT_TRUE(succeeded(render(scratch_ / "out_%03d.png", {})));
    const RunResult compared =
        run_matchlight({"compare", shot_ / "truth_%03d.png", scratch_ / "out_%03d.png", "--region", plate, "--json"});
    ASSERT_TRUE(succeeded(compared));
    const auto inside = nlohmann::json::parse(compared.standard_output).at("mean").at("inside");
    // Nothing at all scores 0.496 there.
    EXPECT_LT(inside.at("flip").get<double>(), 0.20);
}

TEST_F(RenderTest, ExrHoldsLinearLightAndEveryLayer) {
    const fs::path output = scratch_ / "out_%03d.exr";
    ASSERT_TRUE(succeeded(render(output, {"--frames", "6-6", "--level", "draft"})));
    const fs::path file = numbered(output, 6);
    const ImageF beauty = read_exr_part(file, "beauty", {"R", "G", "B"});
    const ImageF plate = read_exr_part(file, "plate", {"R", "G", "B"});
    const ImageF alpha = read_exr_part(file, "alpha", {"A"});
    const ImageF depth = read_exr_part(file, "depth", {"Z"});
    const ImageF normal = read_exr_part(file, "normal", {"X", "Y", "Z"});
    const ImageF shadow = read_exr_part(file, "shadow", {"R", "G", "B"});
    const ImageF object_id = read_exr_part(file, "object_id", {"id"});
    ASSERT_EQ(beauty.width(), 640);
    ASSERT_EQ(beauty.height(), 360);
    int solid = 0, shaded = 0;
    for (int y = 0; y < 360; ++y) {
        for (int x = 0; x < 640; ++x) {
            if (alpha.at(x, y) == 1 && object_id.at(x, y) == 1) {
                ++solid;
                // The camera stands 0.5 to 0.7 m from the objects.
                EXPECT_GT(depth.at(x, y), 0.4F);
                EXPECT_LT(depth.at(x, y), 0.8F);
                EXPECT_NEAR(std::hypot(normal.at(x, y, 0), normal.at(x, y, 1), normal.at(x, y, 2)), 1, 2e-3);
            } else if (alpha.at(x, y) == 0) {
                // Only the shadow lies between plate and picture there; both are half floats.
                for (int c = 0; c < 3; ++c) {
                    EXPECT_NEAR(beauty.at(x, y, c), plate.at(x, y, c) * shadow.at(x, y, c), 4e-3);
                }
                shaded += shadow.at(x, y, 1) < 0.9F ? 1 : 0;
            }
        }
    }
    EXPECT_GT(solid, 6000);
    EXPECT_GT(shaded, 2000);
}

TEST_F(RenderTest, GathersTheSurfaceAndMakesADamagedFileAgain) {
    const fs::path gathered = shot_ / "table.surface.exr";
    const fs::path first = scratch_ / "first_%03d.png", second = scratch_ / "second_%03d.png";
    const RunResult run = render(first, {"--frames", "5-5", "--level", "preview", "--json"});
    ASSERT_TRUE(succeeded(run));
    EXPECT_EQ(nlohmann::json::parse(run.standard_output)["frames"][0]["clipped_under_shadow"], 0);
    ASSERT_TRUE(fs::exists(gathered));
    const std::string made = bytes_of(gathered);

    // The clip looks at the table in every frame; the rest of the rectangle is what it never saw.
    const ImageF picture = read_exr_part(gathered, "radiance", {"R", "G", "B", "A"});
    std::int64_t known = 0;
    for (std::size_t i = 3; i < picture.samples().size(); i += 4) known += picture.samples()[i] > 0.5f ? 1 : 0;
    EXPECT_GT(known, static_cast<std::int64_t>(picture.width()) * picture.height() / 4);

    fs::resize_file(gathered, made.size() / 2);
    ASSERT_TRUE(succeeded(render(second, {"--frames", "5-5", "--level", "preview"})));
    EXPECT_EQ(bytes_of(gathered), made);
    EXPECT_EQ(bytes_of(numbered(first, 5)), bytes_of(numbered(second, 5)));
}

TEST_F(RenderTest, AFrameWithoutAPoseIsThePlate) {
    const fs::path solve = shot_ / "table.solve.json";
    nlohmann::json json = nlohmann::json::parse(bytes_of(solve));
    json["frames"][4]["camera_from_world"] = nullptr;
    std::ofstream(solve, std::ios::binary | std::ios::trunc) << json;
    const RunResult result = render(
        scratch_ / "out_%03d.png", {"--frames", "4-4", "--level", "draft", "--touched", scratch_ / "touched_%03d.png"});
    EXPECT_TRUE(succeeded(result));
    EXPECT_TRUE(warned_of(result, {"plate.mp4", "pose"}));
    const Image8 touched = read_mask(scratch_ / "touched_004.png");
    for (const std::uint8_t pixel : touched.samples()) ASSERT_EQ(pixel, 0);
}

TEST_F(RenderTest, VideosKeepLengthAndTimes) {
    for (const auto& [codec, name] : std::vector<std::pair<std::string, std::string>>{
             {"h264", "out.mp4"}, {"h265", "out265.mp4"}, {"ffv1", "out.mkv"}}) {
        if (codec != "h264") change_scene("codec = \"h26", "codec = \"" + codec + "\" #");
        const fs::path output = scratch_ / name;
        ASSERT_TRUE(succeeded(render(output, {"--level", "draft"}))) << codec;
        const auto footage = FrameSource::open(shot_ / "plate.mp4", {}, warnings_);
        const auto rendered = FrameSource::open(output, {}, warnings_);
        int frames = 0;
        while (const auto frame = rendered->next()) {
            const auto original = footage->next();
            ASSERT_TRUE(original);
            EXPECT_NEAR(frame->time_s(), original->time_s(), 1e-3);
            ++frames;
        }
        EXPECT_EQ(frames, 12) << codec;
        if (codec == "h265") change_scene("codec = \"h265\" #", "codec = \"h26");
    }
}

TEST_F(RenderTest, ProresHoldsTheVirtualLayerAlone) {
    change_scene("codec = \"h264\"", "codec = \"prores4444\"");
    const fs::path output = scratch_ / "layer.mov";
    ASSERT_TRUE(succeeded(render(output, {"--frames", "3-3", "--level", "draft"})));
    const auto layer = FrameSource::open(output, {}, warnings_);
    EXPECT_TRUE(layer->info().format.has_alpha);
    const auto frame = layer->next();
    ASSERT_TRUE(frame);
    // A corner shows nothing virtual: black under an alpha of 0.
    const Image8 corner = frame->rgb8({0, 0, 8, 8});
    for (const std::uint8_t sample : corner.samples()) EXPECT_LE(sample, 1);
}

TEST_F(RenderTest, ReflectsInTheClassicFormToo) {
    change_scene("model = \"objects.glb\"", "reflection = \"sphere_map\"\nmodel = \"objects.glb\"");
    const RunResult result = render(scratch_ / "classic_%03d.png", {"--frames", "2-2", "--level", "draft", "--json"});
    ASSERT_TRUE(succeeded(result));
    const auto frames = nlohmann::json::parse(result.standard_output).at("frames");
    EXPECT_GT(frames.at(0).at("touched_pixels").get<int>(), 8000);
}

TEST_F(RenderTest, WrongCallsAreRefused) {
    EXPECT_TRUE(refused_call(render(scratch_ / "out.mp4", {"--frames", "5-3"})));
    EXPECT_TRUE(refused_call(render(scratch_ / "out.mp4", {"--level", "best"})));
    EXPECT_TRUE(failed_naming(render(scratch_ / "out.gif", {}), {"out.gif", ".mp4"}));
    EXPECT_TRUE(failed_naming(render(scratch_ / "out.mp4", {"--frames", "500-"}), {"plate.mp4", "500"}));
    EXPECT_TRUE(nothing_left_of(scratch_ / "out.mp4"));
}

}  // namespace
}  // namespace matchlight::test
