// matchlight probe build, as a user runs it: on the table's photographs, and on what cannot become a probe.
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "core/image.h"
#include "media/image_io.h"
#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class ProbeBuild : public CommandTest {
protected:
    std::string camera(int width, int height) const {
        const fs::path path = scratch_ / "camera.yaml";
        std::ofstream(path)
            << "%YAML:1.0\n---\nimage_width: " << width << "\nimage_height: " << height
            << "\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 400., 0., "
            << (width - 1) / 2.0 << ", 0., 400., " << (height - 1) / 2.0
            << ", 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n"
               "   dt: d\n   data: [ 0., 0., 0., 0., 0. ]\n";
        return path.string();
    }
    std::string picture(const std::string& name, int width = 160, int height = 120) const {
        ImageF image(width, height, 3);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                for (int c = 0; c < 3; ++c) image.at(x, y, c) = 0.3F + 0.001F * static_cast<float>(x);
            }
        }
        const fs::path path = scratch_ / name;
        write_exr(path, width, height, {{"radiance", {"R", "G", "B"}, &image, false, {}}}, {});
        return path.string();
    }
    /// Refused in one line with `words`, nothing written.
    void expect_refused(std::vector<std::string> arguments, const std::vector<std::string>& words) const {
        const std::string out = (scratch_ / "out.exr").string();
        arguments.insert(arguments.begin(), {"probe", "build", "-o", out});
        EXPECT_TRUE(failed_naming(run_matchlight(arguments), words));
        EXPECT_TRUE(nothing_left_of(out));
    }
};

TEST_F(ProbeBuild, RefusesWhatCannotBecomeAProbe) {
    const std::string lens = camera(160, 120), plain = picture("plain.exr");
    expect_refused({"--view", plain, "--camera", lens, "--ball-radius", "0.035"},
                   {"plain.exr", "no ball", "looked for a circle"});
    expect_refused({"--view", plain, "--camera", lens, "--ball-radius", "0"}, {"radius"});
    expect_refused({"--view", plain, "--camera", lens, "--ball-radius", "nan"}, {"radius"});
    expect_refused({"--view", (scratch_ / "missing.exr").string(), "--camera", lens, "--ball-radius", "0.035"},
                   {"missing.exr"});
    expect_refused({"--view", plain, "--camera", (scratch_ / "none.yaml").string(), "--ball-radius", "0.035"},
                   {"none.yaml"});
    expect_refused({"--view", plain, "--camera", camera(200, 120), "--ball-radius", "0.035"}, {"plain.exr"});
    expect_refused({"--view", plain, "--camera", camera(160, 120), "--ball-radius", "0.035", "--reflectance", "1.5"},
                   {"reflectance"});
    expect_refused(
        {"--view", plain, "--camera", lens, "--ball-radius", "0.035", "--circle", "80,60,30", "--circle", "80,60,30"},
        {"2 circles for 1 views"});
    fs::create_directory(scratch_ / "empty");
    expect_refused({"--view", (scratch_ / "empty").string(), "--camera", lens, "--ball-radius", "0.035"},
                   {"empty", "no photograph"});
}

TEST_F(ProbeBuild, RefusesWhatCannotBeADiffuseBall) {
    const std::string lens = camera(160, 120), plain = picture("plain.exr");
    const std::vector<std::string> mirror = {"--view", plain, "--camera", lens, "--ball-radius", "0.035"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), mirror.begin(), mirror.end());
        return more;
    };
    expect_refused(with({"--diffuse-albedo", "0.18"}), {"--sun-from-diffuse-ball"});
    expect_refused(with({"--sun-from-diffuse-ball", plain, "--diffuse-albedo", "18"}),
                   {"--diffuse-albedo", "at most 1"});
    expect_refused(with({"--sun-from-diffuse-ball", (scratch_ / "none.exr").string()}), {"none.exr"});
    // An .exr says radiance, a .png is developed here: nobody knows the factor between them.
    const std::string developed = (scratch_ / "grey.png").string();
    Image16 grey(160, 120, 3);
    write_png16(developed, grey);
    expect_refused(with({"--sun-from-diffuse-ball", developed}), {"grey.png", "merged already"});
}

TEST_F(ProbeBuild, RepairsWhatIsNoDeviation) {
    ImageF image(160, 120, 6, 0.3F);
    image.at(5, 5, 3) = std::numeric_limits<float>::quiet_NaN();
    image.at(6, 5, 4) = -1;
    image.at(7, 5, 5) = std::numeric_limits<float>::infinity();
    const fs::path path = scratch_ / "merged.exr";
    const std::vector<std::string> channels = {"R", "G", "B", "sigma.R", "sigma.G", "sigma.B"};
    write_exr(path, 160, 120, {{"radiance", channels, &image, false, {}}}, {});
    // It holds no ball; but its samples are repaired, and counted, as it is read.
    const RunResult result = run_matchlight({"probe", "build", "-o", (scratch_ / "out.exr").string(), "--view",
                                             path.string(), "--camera", camera(160, 120), "--ball-radius", "0.035"});
    EXPECT_TRUE(failed_naming(result, {"merged.exr", "no ball"}));
    EXPECT_NE(result.standard_error.find("3 samples of sigma"), std::string::npos) << result.standard_error;
}

TEST_F(ProbeBuild, RefusesToWriteOverItsPhotographs) {
    const std::string plain = picture("plain.exr");
    EXPECT_TRUE(failed_naming(run_matchlight({"probe", "build", "-o", plain, "--overwrite", "--view", plain, "--camera",
                                              camera(160, 120), "--ball-radius", "0.035"}),
                              {"plain.exr", "the output is the input"}));
}

/// The photographs of the table's ball, in the folder of further test data.
class TableBall : public SharedDataTest {
protected:
    std::vector<std::string> arguments(int darkest, int views) const {
        const fs::path balls = data_ / "table" / "balls";
        std::vector<std::string> result;
        for (int v = 0; v < views; ++v) {
            result.emplace_back("--view");
            for (int b = 0; b <= darkest; ++b) {
                result.push_back((balls / ("v" + std::to_string(v) + "_b" + std::to_string(b) + ".jpg")).string());
            }
        }
        for (const std::string& one :
             {std::string("--camera"), (balls / "camera.yaml").string(), std::string("--ball-radius"),
              std::string("0.035"), std::string("--rig"),
              (fs::path(MATCHLIGHT_SOURCE_DIR) / "samples" / "table" / "table.toml").string()}) {
            result.push_back(one);
        }
        return result;
    }
};

TEST_F(TableBall, BecomesTheLightThatWasThere) {
    const std::string out = (scratch_ / "probe.exr").string();
    std::vector<std::string> call = {"probe", "build", "--json", "-o", out};
    const auto rest = arguments(8, 2);
    call.insert(call.end(), rest.begin(), rest.end());
    const RunResult result = run_matchlight(call);
    ASSERT_TRUE(succeeded(result));
    const json built = json::parse(result.standard_output);
    // The ball stands at (0, 0.02, 0.0355) and reflects nine tenths.
    EXPECT_NEAR(built["ball"]["centre_m"][0].get<double>(), 0, 3e-4);
    EXPECT_NEAR(built["ball"]["centre_m"][1].get<double>(), 0.02, 3e-4);
    EXPECT_NEAR(built["ball"]["centre_m"][2].get<double>(), 0.0355, 3e-4);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(built["ball"]["reflectance"][c].get<double>(), 0.9, 0.03);
    EXPECT_TRUE(built["views"][0]["pose_from_ball"].get<bool>());  // it shows no whole tag
    EXPECT_NEAR(built["views"][0]["eye_m"][0].get<double>(), -0.25, 5e-4);
    EXPECT_NEAR(built["views"][1]["eye_m"][0].get<double>(), 0.45, 5e-4);

    const RunResult compared =
        run_matchlight({"probe", "compare", "--json", (data_ / "table" / "probe.exr").string(), out});
    ASSERT_TRUE(succeeded(compared));
    const json score = json::parse(compared.standard_output);
    // Hand work with the exact circle gets 0.070, 0.56° and 0.075 EV.
    EXPECT_LT(score["irradiance_rmse"].get<double>(), 0.035);
    EXPECT_LT(score["brightest_angle_deg"].get<double>(), 0.3);
    EXPECT_LT(score["median_abs_ev"].get<double>(), 0.055);
}

TEST_F(TableBall, WithoutPlacesTheAxesAreThoseThatTheSceneWasTrackedIn) {
    const fs::path table = data_ / "table", scene = scratch_ / "shot.toml";
    std::ofstream(scene) << "[footage]\nvideo = '" << (table / "plate.mp4").string() << "'\ncamera = '"
                         << (table / "camera.yaml").string()
                         << "'\n[tags]\nrig = [{id = 0, size = 0.08}, {id = 1, size = 0.08}]\n";
    const auto centre = [&](const std::string& said) {
        const fs::path balls = table / "balls";
        const RunResult result =
            run_matchlight({"probe", "build", "--json", "--overwrite", "-o", (scratch_ / "probe.exr").string(),
                            "--view", (balls / "v1_b1.jpg").string(), (balls / "v1_b3.jpg").string(), "--camera",
                            (balls / "camera.yaml").string(), "--ball-radius", "0.035", "--rig", scene.string(),
                            "--size", "64", "--circle", "450,337,110"});
        EXPECT_TRUE(succeeded(result));
        EXPECT_EQ(result.standard_error.find("whole here") != std::string::npos, !said.empty());
        EXPECT_NE(result.standard_error.find(said), std::string::npos);
        const json at = json::parse(result.standard_output)["ball"]["centre_m"];
        return Eigen::Vector3d(at[0].get<double>(), at[1].get<double>(), at[2].get<double>());
    };
    // The ball hides tag 0, which is the world. It stands 2 cm off its middle, 14 cm from tag 1, turned by 90°. One
    // view tells the ball's distance within some millimetres; the two worlds lie 14 cm apart.
    constexpr double near_m = 0.01;
    EXPECT_LT((centre("those of tag 1") - Eigen::Vector3d(0.02, -0.14, 0.035)).norm(), near_m);
    json solve = {{"matchlight_solve", 1},
                  {"footage", {{"file", "plate.mp4"}, {"width", 640}, {"height", 360}, {"frames", 12}}},
                  {"lens",
                   {{"camera_matrix", {{622, 0, 319.5}, {0, 622, 179.5}, {0, 0, 1}}},
                    {"distortion", {0, 0, 0, 0, 0}},
                    {"model", "radtan"}}},
                  {"photometry", {{"response", "srgb"}}},
                  {"frames", json::array()}};
    solve["rig"] = {
        {{"id", 0}, {"size_m", 0.08}, {"world_from_tag", {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}},
        {{"id", 1},
         {"size_m", 0.08},
         {"world_from_tag", {{0, -1, 0, -0.14}, {1, 0, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}}};
    std::ofstream(scratch_ / "shot.solve.json") << solve;
    EXPECT_LT((centre("") - Eigen::Vector3d(0, 0.02, 0.035)).norm(), near_m);
}

TEST_F(TableBall, LampsThatEveryPhotographClipsGetTheirEnergyFromTheTags) {
    const std::string out = (scratch_ / "clipped.exr").string();
    std::vector<std::string> call = {"probe", "build", "--json", "-o", out, "--size", "256"};
    const auto rest = arguments(6, 2);  // without the two darkest of nine
    call.insert(call.end(), rest.begin(), rest.end());
    const RunResult result = run_matchlight(call);
    ASSERT_TRUE(succeeded(result));
    const json built = json::parse(result.standard_output);
    ASSERT_EQ(built["clipped_lights"].size(), 2u);
    EXPECT_GT(built["clipped_lights"][0]["gain"][1].get<double>(), 2.5);
    EXPECT_GT(built["clipped_share"].get<double>(), 0);
    const RunResult compared =
        run_matchlight({"probe", "compare", "--json", (data_ / "table" / "probe.exr").string(), out});
    ASSERT_TRUE(succeeded(compared));
    const json score = json::parse(compared.standard_output);
    // 15 % are 0.2 EV.
    for (int lamp = 0; lamp < 2; ++lamp) EXPECT_LT(std::abs(score["lights"][lamp]["power_ev"].get<double>()), 0.2);
}

}  // namespace
}  // namespace matchlight::test
