// matchlight probe, as a user runs it: what it says of known light, what it writes, and what bad input gets.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "handmade_images.h"
#include "media/image_io.h"
#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double pi = std::numbers::pi;
const std::string sample_probe = (fs::path(MATCHLIGHT_SOURCE_DIR) / "samples" / "table" / "probe.exr").string();

json probe_json(const std::vector<std::string>& arguments) {
    std::vector<std::string> all = {"probe", "--json"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const RunResult result = run_matchlight(all);
    EXPECT_TRUE(succeeded(result));
    return json::parse(result.standard_output, nullptr, false);
}

class ProbeCommand : public CommandTest {
protected:
    std::string write(const std::string& name, const HandmadeExr& exr) const {
        return scratch_.write(name, exr.bytes()).string();
    }
    std::string in_scratch(const std::string& name) const { return (scratch_ / name).string(); }

    /// Walls of 1 and a lamp of 1000 in a block of pixels to the right (+x), 30° up.
    std::string lamp() const {
        HandmadeExr exr{.width = 128, .height = 64};
        exr.sample = [](int x, int y, int) {
            return std::abs(x - 95.5) < 2 && std::abs(y - 20.8) < 2 ? 1000.0f : 1.0f;
        };
        return write("lamp.exr", exr);
    }
    /// Both subcommands refuse `input` naming it and each of `words`, and nothing is written.
    void expect_refused(const std::string& input, std::vector<std::string> words) const {
        words.push_back(fs::path(input).filename().string());
        EXPECT_TRUE(failed_naming(run_matchlight({"probe", "info", input}), words));
        const std::string output = in_scratch("refused_out.exr");
        EXPECT_TRUE(failed_naming(run_matchlight({"probe", "convert", input, "-o", output, "--to", "angular"}), words));
        EXPECT_TRUE(nothing_left_of(output));
    }
};

TEST_F(ProbeCommand, InfoOfAWhiteFurnace) {
    const json info = probe_json({"info", write("white.exr", {.width = 64, .height = 32})});
    EXPECT_EQ(info["mapping"], "latlong");
    EXPECT_EQ(info["recognised_by"], "shape");
    EXPECT_EQ(info["width"], 64);
    for (const char* face : {"+x", "-x", "+y", "-y", "+z", "-z"}) {
        for (const auto& channel : info["irradiance"][face]) {
            EXPECT_NEAR(channel.get<double>(), pi, 3e-3 * pi);  // (π/32)²/4: pixels that the horizon cuts
        }
    }
    EXPECT_NEAR(info["spherical_harmonics"][0][0].get<double>(), std::sqrt(4 * pi), 1e-6);
    EXPECT_EQ(info["luminance"]["dynamic_range_ev"], 0);
    EXPECT_TRUE(info["dominant_lights"].empty());
    EXPECT_EQ(info["clipped_pixels"], 0);
}

TEST_F(ProbeCommand, InfoFindsALamp) {
    const json info = probe_json({"info", lamp()});
    ASSERT_EQ(info["dominant_lights"].size(), 1u);
    const json light = info["dominant_lights"][0];
    EXPECT_NEAR(light["azimuth_deg"].get<double>(), 0, 0.2);  // columns 94 to 97 of 128 are centred on +x
    EXPECT_NEAR(light["elevation_deg"].get<double>(), 90 - 180 * (20.5 + 0.5) / 64, 0.5);
    const double band = std::cos(19 * pi / 64) - std::cos(23 * pi / 64);
    EXPECT_NEAR(light["solid_angle_sr"].get<double>(), 4 * 2 * pi / 128 * band, 1e-6);
    EXPECT_NEAR(light["power"][0].get<double>(), 1000 * 4 * 2 * pi / 128 * band, 1e-3);
    EXPECT_EQ(info["clipped_pixels"], 16);  // sixteen pixels share the top
    EXPECT_NEAR(info["luminance"]["dynamic_range_ev"].get<double>(), std::log2(1000.0), 1e-6);
}

TEST_F(ProbeCommand, InfoTellsItInWordsToo) {
    const RunResult result = run_matchlight({"probe", "info", lamp()});
    ASSERT_TRUE(succeeded(result));
    for (const char* word : {"128 x 64", "latlong", "irradiance", "dominant lights", "clipped pixels: 16"}) {
        EXPECT_NE(result.standard_output.find(word), std::string::npos) << word;
    }
}

TEST_F(ProbeCommand, InfoWritesAPageThatStandsAlone) {
    const std::string page = in_scratch("lamp.html");
    const json info = probe_json({"info", lamp(), "--page", page});
    EXPECT_EQ(info["page"], page);
    EXPECT_EQ(info["median_cut"].size(), 16u);
    double share = 0;
    for (const json& part : info["median_cut"]) share += part["power_share"].get<double>();
    EXPECT_NEAR(share, 1, 1e-6);
    const std::string html = read_text_file(page);
    // The sphere, the ball, four exposures, irradiance and coverage; the lamp marked on both.
    std::size_t pictures = 0;
    for (std::size_t at = 0; (at = html.find("data:image/png;base64,", at)) != std::string::npos; ++at) ++pictures;
    EXPECT_EQ(pictures, 8u);
    for (const char* word : {"class=\"lamp\"", "Median cut", "spherical harmonic", "clipped (flat tops)"}) {
        EXPECT_NE(html.find(word), std::string::npos) << word;
    }
    for (const char* outside : {"http://", "https://", "src=\"/"}) {
        EXPECT_EQ(html.find(outside), std::string::npos) << outside;
    }
    EXPECT_TRUE(failed_naming(run_matchlight({"probe", "info", lamp(), "--page", page}), {"lamp.html", "overwrite"}));
}

TEST_F(ProbeCommand, APageOfBlackLightSaysSo) {
    const std::string page = in_scratch("black.html");
    const json info = probe_json(
        {"info", write("black.exr", {.width = 32, .height = 16, .sample = [](int, int, int) { return 0.0f; }}),
         "--page", page});
    EXPECT_TRUE(info["dominant_lights"].empty());
    EXPECT_NE(read_text_file(page).find("All black"), std::string::npos);
    EXPECT_EQ(read_text_file(page).find("nan<"), std::string::npos);
}

TEST_F(ProbeCommand, LatlongToCubeAndBackKeepsIrradiance) {
    // The sample's light: lamps of a few pixels, 25 EV of range.
    const json before = probe_json({"info", sample_probe});
    for (const char* layout : {"vertical-cross", "column"}) {
        const std::string cube = in_scratch(std::string(layout) + ".exr");
        const json written = probe_json({"convert", sample_probe, "-o", cube, "--to", "cube", "--cube-layout", layout});
        EXPECT_EQ(written["cube_layout"], layout);
        const std::string back = in_scratch(std::string(layout) + "_back.exr");
        EXPECT_TRUE(succeeded(run_matchlight({"probe", "convert", cube, "-o", back, "--to", "latlong"})));
        const json after = probe_json({"info", back});
        EXPECT_EQ(after["width"], before["width"]);
        for (const char* face : {"+x", "-x", "+y", "-y", "+z", "-z"}) {
            for (int c = 0; c < 3; ++c) {
                const double expected = before["irradiance"][face][c];
                EXPECT_NEAR(after["irradiance"][face][c].get<double>(), expected, 1e-3 * expected)
                    << layout << " " << face;
            }
        }
    }
}

TEST_F(ProbeCommand, EveryMappingAndExtensionComesBackAsItself) {
    for (const char* mapping : {"latlong", "angular", "mirrorball", "cube"}) {
        for (const char* extension : {".exr", ".hdr"}) {
            const std::string output = in_scratch(std::string(mapping) + extension);
            ASSERT_TRUE(
                succeeded(run_matchlight({"probe", "convert", lamp(), "-o", output, "--to", mapping, "--size", "96"})));
            const json info = probe_json({"info", output});  // the names tell mirror balls apart in .hdr
            EXPECT_EQ(info["mapping"], mapping) << output;
            ASSERT_FALSE(info["dominant_lights"].empty());
            EXPECT_NEAR(info["dominant_lights"][0]["azimuth_deg"].get<double>(), 0, 2) << output;
            EXPECT_NEAR(info["dominant_lights"][0]["elevation_deg"].get<double>(), 31, 2) << output;
        }
    }
}

TEST_F(ProbeCommand, ConvertTurnsAndScales) {
    const std::string output = in_scratch("turned.exr");
    ASSERT_TRUE(succeeded(run_matchlight(
        {"probe", "convert", lamp(), "-o", output, "--to", "latlong", "--rotation-deg", "90", "--exposure-ev", "1"})));
    const json info = probe_json({"info", output});
    EXPECT_NEAR(info["dominant_lights"][0]["azimuth_deg"].get<double>(), 90, 0.2);  // from +x to +y
    EXPECT_NEAR(info["luminance"]["largest"].get<double>(), 2000, 1);
}

TEST_F(ProbeCommand, CompareMeasuresWhatConvertDidToALamp) {
    const std::string turned = in_scratch("turned_lamp.exr");
    ASSERT_TRUE(succeeded(run_matchlight(
        {"probe", "convert", lamp(), "-o", turned, "--to", "latlong", "--rotation-deg", "2", "--exposure-ev", "3"})));
    const json result = probe_json({"compare", lamp(), turned});
    EXPECT_NEAR(result["gain"][1].get<double>(), 0.125, 1e-3);
    EXPECT_NEAR(result["mean_ev"].get<double>(), 0, 0.02);
    ASSERT_EQ(result["lights"].size(), 1u);
    EXPECT_NEAR(result["lights"][0]["angle_deg"].get<double>(), 2 * std::cos(30.94 * pi / 180), 0.05);
    EXPECT_NEAR(result["lights"][0]["power_ev"].get<double>(), 0, 0.02);
    EXPECT_GT(result["irradiance_rmse"].get<double>(), 0.001);
    const json itself = probe_json({"compare", lamp(), lamp(), "--gain", "none"});
    EXPECT_NEAR(itself["irradiance_rmse"].get<double>(), 0, 1e-9);
    EXPECT_TRUE(failed_naming(run_matchlight({"probe", "compare", lamp(), in_scratch("absent.exr")}), {"absent.exr"}));
}

TEST_F(ProbeCommand, ViewDrawsBallsThatTheProbeLights) {
    // Even light: the furnace. Grey ball and ground send half of it, chrome 0.95.
    const std::string white = write("even.exr", {.width = 64, .height = 32});
    const std::string output = in_scratch("balls.exr");
    const json view =
        probe_json({"view", white, "-o", output, "--size", "40", "--exposure-ev", "0", "--level", "draft"});
    ASSERT_EQ(view["width"], 240);
    ASSERT_EQ(view["height"], 112);
    const ImageF light = read_exr_part(output, "", {"R", "G", "B"});
    EXPECT_NEAR(light.at(5, 5, 1), 1, 0.01);         // the probe behind
    EXPECT_NEAR(light.at(28, 28, 1), 0.5, 0.03);     // the grey ball; its varnish adds a little
    EXPECT_NEAR(light.at(74, 28, 1), 0.95, 0.02);    // the chrome ball
    EXPECT_NEAR(light.at(120, 57, 1), 0.5, 0.02);    // the ground far behind the balls
    EXPECT_LT(light.at(74, 56 + 28 + 19, 1), 0.9f);  // the chrome ball shows the ground's shadow below
    const std::string picture = in_scratch("balls.png");
    ASSERT_TRUE(succeeded(run_matchlight({"probe", "view", white, "-o", picture, "--size", "40", "--level", "draft"})));
    // Exposed for the grey ball at 60 % of white.
    EXPECT_NEAR(read_rgb8(picture).at(28, 28, 1), 255 * 0.797, 5);
    EXPECT_TRUE(failed_naming(run_matchlight({"probe", "view", white, "-o", picture}), {"balls.png", "overwrite"}));
    EXPECT_TRUE(failed_naming(run_matchlight({"probe", "view", white, "-o", in_scratch("balls.jpg")}), {"balls.jpg"}));
}

TEST_F(ProbeCommand, CompareTellsHowDifferentObjectsLook) {
    const std::string turned = in_scratch("other_side.exr");
    ASSERT_TRUE(succeeded(
        run_matchlight({"probe", "convert", lamp(), "-o", turned, "--to", "latlong", "--rotation-deg", "120"})));
    const std::string picture = in_scratch("difference.png");
    const json other = probe_json({"compare", lamp(), turned, "--picture", picture});
    EXPECT_GT(other["balls"]["flip"].get<double>(), 0.05);
    EXPECT_EQ(read_rgb8(picture).width(), 1152);
}

TEST_F(ProbeCommand, ConvertKeepsWhatAProbeSaysOfItself) {
    // The half towards +x was not seen; turned by 180° it is the half towards −x. What was seen lies 2 m away.
    ImageF image(64, 32, 5, 1.0f);
    for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 64; ++x) {
            image.at(x, y, 3) = x < 32 ? 1.0f : 0.0f;
            image.at(x, y, 4) = x < 32 ? 2.0f : 0.0f;
        }
    }
    const std::string built = in_scratch("built.exr");
    write_exr(built, 64, 32,
              {{.name = "",
                .channels = {"R", "G", "B", "seen", "distance_m"},
                .image = &image,
                .half = true,
                .data_window = {}}},
              {{"place_m", "0 0.02 0.04"}, {"source", "ball_1.jpg"}});
    const std::string turned = in_scratch("turned_built.exr");
    ASSERT_TRUE(succeeded(
        run_matchlight({"probe", "convert", built, "-o", turned, "--to", "latlong", "--rotation-deg", "180"})));
    const json info = probe_json({"info", turned});
    EXPECT_NEAR(info["unseen_share"].get<double>(), 0.5, 1e-3);
    EXPECT_EQ(info["metadata"]["place_m"], "0 0.02 0.04");
    EXPECT_EQ(info["metadata"]["source"], "ball_1.jpg");
    const ImageF seen = read_exr_part(turned, "rgb", {"seen"});
    EXPECT_NEAR(seen.at(10, 16), 0, 1e-3);
    EXPECT_NEAR(seen.at(50, 16), 1, 1e-3);
    const ImageF distance_m = read_exr_part(turned, "rgb", {"distance_m"});
    EXPECT_EQ(distance_m.at(10, 16), 0);
    EXPECT_NEAR(distance_m.at(50, 16), 2, 1e-3);
    const std::string cube = in_scratch("built_cube.exr");
    ASSERT_TRUE(succeeded(run_matchlight({"probe", "convert", built, "-o", cube, "--to", "cube"})));
    const json of_cube = probe_json({"info", cube});
    EXPECT_NEAR(of_cube["unseen_share"].get<double>(), 0.5, 0.01);
    EXPECT_NEAR(of_cube["distances"]["median_m"].get<double>(), 2, 2e-3);
    EXPECT_GE(of_cube["distances"]["least_m"].get<double>(), 2 - 2e-3);
}

TEST_F(ProbeCommand, ConvertKeepsASunBeyondHalfRange) {
    HandmadeExr exr{.width = 32, .height = 16};
    exr.sample = [](int x, int y, int) { return x == 20 && y == 5 ? 1e6f : 1.0f; };
    const std::string output = in_scratch("sun_out.exr");
    const RunResult result =
        run_matchlight({"probe", "convert", write("sun.exr", exr), "-o", output, "--to", "latlong"});
    EXPECT_TRUE(succeeded(result));
    EXPECT_TRUE(warned_of(result, {"sun.exr", "beyond 65504"}));
    EXPECT_NEAR(probe_json({"info", output})["luminance"]["largest"].get<double>(), 1e6, 1);
}

TEST_F(ProbeCommand, EnvmapAttributeIsHonoured) {
    // OpenEXR's own header: 1 = cube, in a column of faces; 0 on a column is a contradiction.
    const json info = probe_json({"info", write("env.exr", {.width = 8, .height = 48, .envmap = "\x01"})});
    EXPECT_EQ(info["recognised_by"], "envmap attribute");
    EXPECT_EQ(info["cube_layout"], "column");
    EXPECT_EQ(info["edge_centred"], true);
    expect_refused(write("liar.exr", {.width = 8, .height = 48, .envmap = std::string(1, '\0')}), {"latlong", "2:1"});
}

TEST_F(ProbeCommand, SamplesThatAreNoLightAreRepairedAndCounted) {
    HandmadeExr exr{.width = 32, .height = 16};
    exr.sample = [](int x, int y, int) {
        if (y != 3) return 1.0f;
        if (x == 1) return std::numeric_limits<float>::quiet_NaN();
        if (x == 2) return std::numeric_limits<float>::infinity();
        if (x == 3) return -4.0f;
        return 1.0f;
    };
    const RunResult result = run_matchlight({"probe", "info", "--json", write("bad.exr", exr)});
    EXPECT_TRUE(succeeded(result));
    EXPECT_TRUE(warned_of(result, {"bad.exr", "3 samples are NaN"}));
    EXPECT_TRUE(warned_of(result, {"bad.exr", "3 samples are infinite"}));
    EXPECT_TRUE(warned_of(result, {"bad.exr", "3 samples are negative"}));
    const json info = json::parse(result.standard_output);
    EXPECT_EQ(info["repaired_samples"]["nan"], 3);
    EXPECT_EQ(info["repaired_samples"]["infinite"], 3);
    EXPECT_EQ(info["repaired_samples"]["negative"], 3);
    EXPECT_NEAR(info["luminance"]["largest"].get<double>(), 65504, 1e-3);
}

TEST_F(ProbeCommand, RadianceFilesOfAnyScanOrderStandUpright) {
    // A picture whose upper right quarter is bright, written in the orders that a resolution line can name.
    const auto bright = [](int x, int y) { return x >= 16 && y < 8 ? 200 : 20; };
    const std::vector<std::pair<std::string, std::function<int(int)>>> orders = {
        {"-Y 16 +X 32", [&](int i) { return bright(i % 32, i / 32); }},
        {"+Y 16 +X 32", [&](int i) { return bright(i % 32, 15 - i / 32); }},
        {"-Y 16 -X 32", [&](int i) { return bright(31 - i % 32, i / 32); }},
        {"+Y 16 -X 32", [&](int i) { return bright(31 - i % 32, 15 - i / 32); }},
        {"+X 32 -Y 16", [&](int i) { return bright(i / 16, i % 16); }},
        {"-X 32 +Y 16", [&](int i) { return bright(31 - i / 16, 15 - i % 16); }},
    };
    const json upright =
        probe_json({"info", scratch_.write("order.hdr", radiance_bytes(32, 16, orders[0].first, orders[0].second))});
    EXPECT_GT(upright["irradiance"]["+z"][0].get<double>(), 2 * upright["irradiance"]["-z"][0].get<double>());
    EXPECT_GT(upright["irradiance"]["+x"][0].get<double>(), 2 * upright["irradiance"]["-x"][0].get<double>());
    for (const auto& [size, brightness] : orders) {
        const json info = probe_json({"info", scratch_.write("order.hdr", radiance_bytes(32, 16, size, brightness))});
        EXPECT_EQ(info["irradiance"], upright["irradiance"]) << size;
    }
}

TEST_F(ProbeCommand, AllBlackIsALight) {
    HandmadeExr exr{.width = 32, .height = 16};
    exr.sample = [](int, int, int) { return 0.0f; };
    const json info = probe_json({"info", write("black.exr", exr)});
    EXPECT_EQ(info["luminance"]["mean"], 0);
    EXPECT_EQ(info["black_share"], 1);
    EXPECT_TRUE(info["dominant_lights"].empty());
    EXPECT_TRUE(succeeded(run_matchlight(
        {"probe", "convert", in_scratch("black.exr"), "-o", in_scratch("black_cube.exr"), "--to", "cube"})));
}

TEST_F(ProbeCommand, DamagedFilesAreRefused) {
    const std::string sound = HandmadeExr{.width = 64, .height = 32}.bytes();
    expect_refused(scratch_.write("empty.exr", ""), {});
    expect_refused(scratch_.write("cut.exr", sound.substr(0, sound.size() / 2)), {});
    expect_refused(scratch_.write("header_cut.exr", sound.substr(0, 100)), {});
    expect_refused(scratch_.write("noise.exr", std::string(5000, '\x5a')), {});
    // Runs of 128 bytes that overflow the line.
    expect_refused(
        write("rle.exr", {.width = 64, .height = 32, .compression = 1, .line_bytes = std::string(60, '\x7f')}), {});
    expect_refused(scratch_.write("cut.hdr", radiance_bytes(64, 32).substr(0, 3000)), {});
    // A run that is longer than its line.
    expect_refused(scratch_.write("rle.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 32 +X 64\n\x02\x02" +
                                                 std::string("\x00\x40", 2) + std::string(4000, '\xff')),
                   {});
    expect_refused(in_scratch("missing.exr"), {});
    expect_refused(scratch_.path().string(), {});
}

TEST_F(ProbeCommand, LyingHeadersAreRefusedBeforeMemoryIsGiven) {
    constexpr int most = std::numeric_limits<std::int32_t>::max();
    constexpr int least = std::numeric_limits<std::int32_t>::min();
    const std::vector<std::pair<std::string, std::string>> liars = {
        {"huge.exr", HandmadeExr{.data_window = {0, 0, 999999, 499999}}.bytes()},
        {"overflow.exr", HandmadeExr{.data_window = {least, least, most, most}}.bytes()},
        {"inverted.exr", HandmadeExr{.data_window = {7, 3, 0, 0}}.bytes()},
        {"huge.hdr", radiance_bytes(4, 2, "-Y 1000000 +X 1000000")},
        {"negative.hdr", radiance_bytes(4, 2, "-Y -16 +X 32")},
    };
    for (const auto& [name, bytes] : liars) {
        const std::string path = scratch_.write(name, bytes);
        const RunResult result = run_matchlight({"probe", "info", path});
        EXPECT_TRUE(failed_naming(result, {name}));
        EXPECT_LT(result.peak_memory_bytes, std::int64_t{300} << 20) << name;
    }
    for (const int count : {2000, 1000000}) {
        HandmadeExr exr{.width = 2, .height = 1, .channels = {}};
        for (int i = 0; i < count; ++i) exr.channels.push_back("c" + std::to_string(10000000 + i));
        const RunResult result = run_matchlight({"probe", "info", write("channels.exr", exr)});
        EXPECT_TRUE(failed_naming(result, {"channels.exr"}));
        EXPECT_LT(result.peak_memory_bytes, std::int64_t{1} << 30) << count;
    }
}

TEST_F(ProbeCommand, KindsOfExrThatHoldNoPicture) {
    expect_refused(write("depth.exr", {.channels = {"Z"}}), {"RGB"});
    expect_refused(write("deep.exr", {.type = "deepscanline", .version_flags = 0x800}), {});
    // One luminance channel is light without colour.
    const json info = probe_json({"info", write("grey.exr", {.width = 32, .height = 16, .channels = {"Y"}})});
    EXPECT_NEAR(info["mean_radiance"][2].get<double>(), 1, 1e-6);
}

TEST_F(ProbeCommand, WrongShapesAreRefused) {
    expect_refused(write("wide.exr", {.width = 50, .height = 20}), {"50 × 20", "2:1"});
    const std::string latlong = write("latlong.exr", {.width = 64, .height = 32});
    EXPECT_TRUE(failed_naming(run_matchlight({"probe", "info", latlong, "--from", "mirrorball"}),
                              {"latlong.exr", "mirrorball", "square"}));
    EXPECT_TRUE(failed_naming(run_matchlight({"probe", "info", latlong, "--from", "cube"}), {"latlong.exr", "cube"}));
}

TEST_F(ProbeCommand, AMissingOrCroppedBallIsRefusedWithWhatWasLookedFor) {
    HandmadeExr exr{.width = 64, .height = 64};
    exr.sample = [](int x, int y, int) { return static_cast<float>(1 + (x * 7 + y * 13) % 29); };
    const std::string picture = write("picture.exr", exr);
    expect_refused(picture, {"looked for a disc"});
    // Said to be a ball, it is taken as one.
    EXPECT_TRUE(succeeded(run_matchlight({"probe", "info", picture, "--from", "mirrorball"})));
}

TEST_F(ProbeCommand, OutputsAreGuarded) {
    const std::string input = lamp();
    const std::string output = scratch_.write("there.exr", "precious").string();
    EXPECT_TRUE(
        failed_naming(run_matchlight({"probe", "convert", input, "-o", output, "--to", "cube"}), {"there.exr"}));
    EXPECT_EQ(bytes_of(output), "precious");
    EXPECT_TRUE(succeeded(run_matchlight({"probe", "convert", input, "-o", output, "--to", "cube", "--overwrite"})));
    EXPECT_NE(bytes_of(output), "precious");

    const std::string before = bytes_of(input);
    EXPECT_TRUE(failed_naming(run_matchlight({"probe", "convert", input, "-o", input, "--to", "cube", "--overwrite"}),
                              {"lamp.exr", "input"}));
    EXPECT_EQ(bytes_of(input), before);
    EXPECT_TRUE(failed_naming(
        run_matchlight({"probe", "convert", input, "-o", in_scratch("probe.png"), "--to", "cube"}), {"probe.png"}));
    EXPECT_TRUE(
        failed_naming(run_matchlight({"probe", "convert", input, "-o", in_scratch("no/folder.exr"), "--to", "cube"}),
                      {"folder.exr"}));
}

TEST_F(ProbeCommand, AFullDiskLeavesNothingBehind) {
    for (const char* name : {"full.exr", "full.hdr"}) {
        RunOptions options;
        options.file_size_limit_bytes = 20000;  // of 200,000
        const std::string output = in_scratch(name);
        EXPECT_TRUE(failed_naming(
            run_matchlight({"probe", "convert", sample_probe, "-o", output, "--to", "angular", "--size", "256"},
                           options),
            {name}));
        EXPECT_TRUE(nothing_left_of(output));
    }
}

TEST_F(ProbeCommand, OddNamesAndLocalesAreFine) {
    const std::string input = scratch_.write("a b\nc.exr", HandmadeExr{.width = 32, .height = 16}.bytes());
    RunOptions options;
    options.environment = {{"LC_ALL", "de_DE.UTF-8"}};
    options.working_directory = scratch_.path();
    const RunResult result = run_matchlight(
        {"probe", "convert", input, "-o", "./-out.exr", "--to", "latlong", "--rotation-deg", "1.5"}, options);
    EXPECT_TRUE(succeeded(result));
    EXPECT_TRUE(fs::exists(scratch_ / "-out.exr"));
}

TEST_F(ProbeCommand, WrongCallsAreRefused) {
    const std::string input = lamp();
    EXPECT_TRUE(refused_call(run_matchlight({"probe"})));
    EXPECT_TRUE(refused_call(run_matchlight({"probe", "info"})));
    EXPECT_TRUE(refused_call(run_matchlight({"probe", "info", input, "--from", "fisheye"})));
    EXPECT_TRUE(refused_call(run_matchlight({"probe", "convert", input, "--to", "cube"})));
    EXPECT_TRUE(refused_call(run_matchlight({"probe", "convert", input, "-o", in_scratch("x.exr")})));
    for (const char* size : {"0", "-5", "1000000", "nan", "x"}) {
        EXPECT_TRUE(refused_call(
            run_matchlight({"probe", "convert", input, "-o", in_scratch("x.exr"), "--to", "cube", "--size", size})))
            << size;
    }
    for (const char* angle : {"nan", "inf", "1e99"}) {
        EXPECT_TRUE(refused_call(run_matchlight(
            {"probe", "convert", input, "-o", in_scratch("x.exr"), "--to", "cube", "--rotation-deg", angle})))
            << angle;
    }
    EXPECT_TRUE(nothing_left_of(in_scratch("x.exr")));
}

using RealProbes = SharedDataTest;

TEST_F(RealProbes, AreRecognisedAndFinite) {
    int count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(data_ / "real/probes")) {
        const std::string extension = entry.path().extension().string();
        if (extension != ".exr" && extension != ".hdr") continue;
        const std::string path = entry.path().string();
        const bool ball =
            path.find("cs445_mirrorball/samples") != std::string::npos && path.find("equi") == std::string::npos;
        const json info = ball ? probe_json({"info", path, "--from", "mirrorball"}) : probe_json({"info", path});
        ASSERT_TRUE(info.is_object()) << path;
        const std::string expected = ball                                                ? "mirrorball"
                                     : path.find("debevec_angular") != std::string::npos ? "angular"
                                     : path.find("KernerEnvCube") != std::string::npos   ? "cube"
                                                                                         : "latlong";
        EXPECT_EQ(info["mapping"], expected) << path;
        EXPECT_GT(info["luminance"]["mean"].get<double>(), 0) << path;
        ++count;
    }
    EXPECT_GE(count, 30);
}

}  // namespace
}  // namespace matchlight::test
