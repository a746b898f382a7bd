// matchlight probe panorama and probe fisheye: pictures of all directions, or of halves, become probes.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include <nlohmann/json.hpp>

#include "../unit/lighting/fisheye_pictures.h"
#include "calibration/camera.h"
#include "core/transfer.h"
#include "lighting/probe_file.h"
#include "media/image_io.h"
#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using nlohmann::json;

const Vector3d lamp = Vector3d(-0.5, -0.7, 0.2).normalized();

class ProbeSphereTest : public CommandTest {
protected:
    std::string at(const std::string& name) const { return (scratch_ / name).string(); }
    void write_light(const std::string& name, const ImageF& light) const {
        write_exr(scratch_ / name, light.width(), light.height(), {{"rgb", {"R", "G", "B"}, &light, false, {}}}, {});
    }
    /// As a camera with the sRGB curve takes it.
    void write_photograph(const std::string& name, const ImageF& light, double exposure) const {
        Image8 code(light.width(), light.height(), 3);
        std::ranges::transform(light.samples(), code.samples().begin(), [&](float sample) {
            return static_cast<std::uint8_t>(
                std::lround(255 * srgb_code_from_linear(std::clamp(exposure * sample, 0.0, 1.0))));
        });
        write_png8(scratch_ / name, code);
    }
    RunResult probe(const std::string& kind, const std::vector<std::string>& more) const {
        std::vector<std::string> arguments = {"--json", "probe", kind};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_matchlight(arguments);
    }
    ImageF read_probe(const std::string& name) const {
        Warnings warnings;
        warnings.set_quiet(true);
        return load_probe(scratch_ / name, {}, warnings).latlong;
    }
};

FisheyeShot half_shot(bool back) {
    FisheyeShot shot;
    shot.width = shot.height = 240;
    shot.circle = {{120, 118}, 110};
    shot.world_from_camera = back ? back_camera() : front_camera();
    return shot;
}

/// Within `tolerance` of the room's light in most directions.
void expect_room(const ImageF& latlong, const Light& room, double gain, double tolerance) {
    int wrong = 0;
    for (int y = 0; y < latlong.height(); ++y) {
        for (int x = 0; x < latlong.width(); ++x) {
            const Vector3d truth = gain * room(latlong_direction(x, y, latlong.width(), latlong.height()));
            wrong += std::abs(latlong.at(x, y, 1) - truth.y()) > tolerance * truth.y() ? 1 : 0;
        }
    }
    EXPECT_LT(wrong, latlong.width() * latlong.height() / 50);
}

TEST_F(ProbeSphereTest, APairOfFisheyesBecomesAProbe) {
    const Light room = striped_room({lamp});
    write_light("front.exr", fisheye_picture(room, half_shot(false)));
    write_light("back.exr", fisheye_picture(room, half_shot(true)));
    const RunResult run = probe("fisheye", {at("front.exr"), "--back", at("back.exr"), "--fov-deg", "200", "-o",
                                            at("probe.exr"), "--size", "256"});
    ASSERT_TRUE(succeeded(run));
    const json result = json::parse(run.standard_output);
    EXPECT_EQ(result["width"], 256);
    EXPECT_NEAR(result["seen_share"], 1, 1e-9);
    EXPECT_NEAR(result["match"]["overlap_deg"], 20, 1e-9);
    EXPECT_NEAR(result["circles"][0]["radius_px"], 110, 0.3);
    EXPECT_EQ(run.standard_error, "");
    expect_room(read_probe("probe.exr"), room, 1, 0.04);
    const ImageF shares = read_exr_part(scratch_ / "probe.exr", "rgb", {"seen"});
    EXPECT_TRUE(std::ranges::all_of(shares.samples(), [](float share) { return share == 1; }));

    // Both in one picture, each on its side, the circles given: the same light.
    ImageF both(480, 240, 3);
    for (const bool back : {false, true}) {
        FisheyeShot shot = half_shot(back);
        shot.world_from_camera =
            shot.world_from_camera * Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ()).toRotationMatrix();
        const ImageF one = fisheye_picture(room, shot);
        for (int y = 0; y < 240; ++y) std::ranges::copy(one.row(y), both.pixel(back ? 240 : 0, y));
    }
    write_light("both.exr", both);
    ASSERT_TRUE(succeeded(
        probe("fisheye", {at("both.exr"), "--side-by-side", "--fov-deg", "200", "--upright-deg", "90,90", "--circle",
                          "120,118,110", "360,118,110", "-o", at("both_probe.exr"), "--size", "256"})));
    expect_room(read_probe("both_probe.exr"), room, 1, 0.04);
    // Other mappings hold the same.
    ASSERT_TRUE(
        succeeded(probe("fisheye", {at("both.exr"), "--side-by-side", "--fov-deg", "200", "--upright-deg", "90,90",
                                    "-o", at("cube.hdr"), "--to", "cube", "--cube-layout", "strip", "--size", "96"})));
    expect_room(read_probe("cube.hdr"), room, 1, 0.1);
}

TEST_F(ProbeSphereTest, BracketedPhotographsAreMergedAndOneHalfIsHalfAProbe) {
    const Light room = striped_room({lamp});
    const ImageF back = fisheye_picture(room, half_shot(true));
    // A quarter of a second, a fifteenth, and a sixtieth: the lamp is 400 times the walls, within the shortest.
    write_photograph("a.png", back, 0.25);
    write_photograph("b.png", back, 0.25 / 16);
    write_photograph("c.png", back, 0.25 / 256);
    const RunResult run =
        probe("fisheye", {at("a.png"), at("b.png"), at("c.png"), "--times", "1/4,1/64,1/1024", "--fov-deg", "200", "-o",
                          at("half.exr"), "--size", "128", "--rotation-deg", "180"});
    ASSERT_TRUE(succeeded(run));
    const json result = json::parse(run.standard_output);
    EXPECT_NEAR(result["seen_share"], 0.58, 0.01);
    EXPECT_TRUE(warned_of(run, {"half.exr", "not seen", "channel"}));
    const ImageF half = read_probe("half.exr");
    // `probe info` says the same of the file.
    const RunResult info = run_matchlight({"--json", "-q", "probe", "info", at("half.exr")});
    ASSERT_TRUE(succeeded(info));
    EXPECT_NEAR(json::parse(info.standard_output)["unseen_share"], 1 - double(result["seen_share"]), 1e-3);
    EXPECT_EQ(json::parse(info.standard_output)["clipped_share"], 0);
    // Turned half round the back's lamp stands where it is in the world; what no photograph shows is black and says so.
    const Eigen::Vector2d seen = latlong_pixel(lamp, 128, 64), unseen = latlong_pixel(-lamp, 128, 64);
    const double scale = result["exposure_scale"];  // walls are at most 2 of its units
    EXPECT_GT(half.at(static_cast<int>(std::lround(seen.x())), static_cast<int>(std::lround(seen.y())), 1), 20 * scale);
    const ImageF shares = read_exr_part(scratch_ / "half.exr", "rgb", {"seen"});
    const int x = static_cast<int>(std::lround(unseen.x())), y = static_cast<int>(std::lround(unseen.y()));
    EXPECT_EQ(half.at(x, y, 1), 0);
    EXPECT_EQ(shares.at(x, y), 0);
}

TEST_F(ProbeSphereTest, ACalibratedLensServesToo) {
    const Light room = striped_room({});
    FisheyeShot shot = half_shot(false);
    write_light("front.exr", fisheye_picture(room, shot));
    Camera camera;
    camera.width = camera.height = 240;
    camera.fx = camera.fy = 110 / (100 * std::numbers::pi / 180);  // equidistant: 110 px at 100°
    camera.cx = 120;
    camera.cy = 118;
    camera.lens = LensModel::fisheye;
    camera.distortion = {0, 0, 0, 0};
    save_camera(scratch_ / "fisheye.yaml", camera);
    ASSERT_TRUE(succeeded(probe("fisheye", {at("front.exr"), "--camera", at("fisheye.yaml"), "--fov-deg", "200", "-o",
                                            at("calibrated.exr"), "--size", "128"})));
    ASSERT_TRUE(
        succeeded(probe("fisheye", {at("front.exr"), "--fov-deg", "200", "-o", at("formula.exr"), "--size", "128"})));
    const ImageF a = read_probe("calibrated.exr"), b = read_probe("formula.exr");
    for (int y = 0; y < 64; ++y) {
        for (int x = 40; x < 88; ++x) EXPECT_NEAR(a.at(x, y, 1), b.at(x, y, 1), 0.02);
    }
}

TEST_F(ProbeSphereTest, APanoramaIsTurnedUpright) {
    const Light room = striped_room({lamp});
    ImageF latlong(256, 128, 3);
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 256; ++x) {
            const Vector3d light = room(latlong_direction(x, y, 256, 128));
            for (int c = 0; c < 3; ++c) latlong.at(x, y, c) = static_cast<float>(light[c]);
        }
    }
    write_light("panorama.exr", latlong);
    // The camera lay on its back: what it calls forward is the world's up.
    ASSERT_TRUE(succeeded(probe("panorama", {at("panorama.exr"), "-o", at("probe.exr"), "--up", "0,1,0"})));
    const ImageF turned = read_probe("probe.exr");
    ASSERT_EQ(turned.width(), 256);
    const Vector3d forward = room(Vector3d::UnitY()), right = room(Vector3d::UnitX());
    EXPECT_NEAR(turned.at(0, 0, 1), forward.y(), 0.03 * forward.y());
    const Eigen::Vector2d px = latlong_pixel(Vector3d::UnitX(), 256, 128);
    EXPECT_NEAR(turned.at(static_cast<int>(std::lround(px.x())), static_cast<int>(std::lround(px.y())), 1), right.y(),
                0.05 * right.y());
    // Photographs of it, merged; in units of the photograph that exposes most of it well.
    write_photograph("long.png", latlong, 0.4);
    write_photograph("short.png", latlong, 0.4 / 64);
    const RunResult run =
        probe("panorama", {at("long.png"), at("short.png"), "--times", "0.4,0.00625", "-o", at("merged.exr")});
    ASSERT_TRUE(succeeded(run));
    const double scale = json::parse(run.standard_output)["exposure_scale"];
    expect_room(read_probe("merged.exr"), room, scale, 0.05);
}

TEST_F(ProbeSphereTest, RefusesWhatShowsNoSphere) {
    write_light("square.exr", ImageF(64, 64, 3, 0.5f));
    write_light("wide.exr", ImageF(128, 64, 3, 0.5f));
    scratch_.write("text.exr", "no picture");
    scratch_.write("empty.png", "");
    const std::string out = at("out.exr");
    const auto refused = [&](const std::string& kind, std::vector<std::string> more,
                             const std::vector<std::string>& words) {
        more.insert(more.end(), {"-o", out});
        EXPECT_TRUE(failed_naming(probe(kind, more), words)) << kind << ' ' << more.front();
        EXPECT_TRUE(nothing_left_of(out));
    };
    refused("panorama", {at("square.exr")}, {"square.exr", "64 × 64", "twice as wide"});
    refused("panorama", {at("text.exr")}, {"text.exr"});
    refused("panorama", {at("empty.png")}, {"empty.png"});
    refused("panorama", {at("nothing.exr")}, {"nothing.exr"});
    refused("panorama", {at("wide.exr"), at("square.exr")}, {"wide.exr", "alone"});
    refused("panorama", {at("wide.exr"), "--up", "0,0,0"}, {"--up", "direction"});
    refused("fisheye", {at("square.exr"), "--fov-deg", "180"}, {"square.exr", "no round picture", "--circle"});
    refused("fisheye", {at("square.exr"), "--fov-deg", "180", "--circle", "500,500,20"},
            {"square.exr", "does not lie"});
    refused("fisheye", {at("square.exr"), "--fov-deg", "190", "--model", "orthographic", "--circle", "32,32,30"},
            {"180.0° at most"});
    refused("fisheye",
            {at("square.exr"), "--fov-deg", "180", "--camera",
             (fs::path(MATCHLIGHT_SOURCE_DIR) / "calib/cameras/table_35mm_640x360.yaml").string()},
            {"table_35mm_640x360.yaml"});
    for (const std::string kind : {"panorama", "fisheye"}) {
        std::vector<std::string> call = {at("wide.exr"), "-o", at("out.png")};
        if (kind == "fisheye") call.insert(call.end(), {"--fov-deg", "180", "--circle", "32,32,30"});
        EXPECT_TRUE(failed_naming(probe(kind, call), {"out.png", ".exr"}));
    }
    const std::vector<std::string> wrong[] = {
        {at("square.exr"), "-o", out},
        {at("square.exr"), "-o", out, "--fov-deg", "nan"},
        {at("square.exr"), "-o", out, "--fov-deg", "180", "--circle", "1,2"},
        {at("square.exr"), "-o", out, "--fov-deg", "180", "--model", "pinhole"},
        {at("square.exr"), "-o", out, "--fov-deg", "180", "--side-by-side", "--back", at("wide.exr")}};
    for (const auto& call : wrong) EXPECT_TRUE(refused_call(probe("fisheye", call)));
    // Its own input is not written over.
    EXPECT_TRUE(failed_naming(probe("panorama", {at("wide.exr"), "-o", at("wide.exr"), "--overwrite"}), {"input"}));
}

}  // namespace
}  // namespace matchlight::test
