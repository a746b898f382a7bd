// matchlight probe calibrate on the sample shot, whose exposure and white balance are known.
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/warnings.h"
#include "media/image_io.h"
#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path sample = fs::path(MATCHLIGHT_SOURCE_DIR) / "samples" / "table";

class ProbeCalibrateCommand : public CommandTest {
protected:
    /// The sample's scene with its paths absolute, and `probe` in place of its own.
    std::string scene_with(const fs::path& probe, const std::string& light = "") const {
        std::string text = read_text_file(sample / "table.toml");
        const auto replace = [&](const std::string& from, const std::string& to) {
            const auto at = text.find(from);
            ASSERT_NE(at, std::string::npos) << from;
            text.replace(at, from.size(), to);
        };
        replace("\"plate.mp4\"", "\"" + (sample / "plate.mp4").string() + "\"");
        replace("\"camera.yaml\"", "\"" + (sample / "camera.yaml").string() + "\"");
        replace("\"objects.glb\"", "\"" + (sample / "objects.glb").string() + "\"");
        replace("probe = \"probe.exr\"", "probe = \"" + probe.string() + "\"\n" + light);
        return scratch_.write("scene_" + probe.stem().string() + ".toml", text).string();
    }

    std::string probe_times(const std::array<float, 3>& gain, const std::string& name) const {
        Warnings warnings;
        warnings.set_quiet(true);
        ImageF image = read_linear_rgb(sample / "probe.exr", warnings);
        for (int y = 0; y < image.height(); ++y) {
            for (int x = 0; x < image.width(); ++x) {
                for (int c = 0; c < 3; ++c) image.at(x, y, c) *= gain.at(static_cast<std::size_t>(c));
            }
        }
        const fs::path path = scratch_ / name;
        write_exr(path, image.width(), image.height(),
                  {{.name = "", .channels = {"R", "G", "B"}, .image = &image, .half = false, .data_window = {}}}, {});
        return path.string();
    }

    json calibration(const std::vector<std::string>& arguments) const {
        std::vector<std::string> all = {"probe", "calibrate", "--json", "-q"};
        all.insert(all.end(), arguments.begin(), arguments.end());
        const RunResult result = run_matchlight(all);
        EXPECT_TRUE(succeeded(result));
        return json::parse(result.standard_output, nullptr, false);
    }
};

TEST_F(ProbeCalibrateCommand, FindsTheFilmCamerasExposureAndBalance) {
    const std::string scene = scene_with(sample / "probe.exr");
    // What the shot was made with: white balance 1.06, 1, 0.93; −0.9 EV in the first frames, −1.4 in the last.
    const json found = calibration({scene, "--frame", "9"});
    EXPECT_NEAR(found["exposure_ev"].get<double>(), -1.4, 0.05);
    EXPECT_NEAR(found["white_balance"][0].get<double>(), 1.06, 0.03);
    EXPECT_NEAR(found["white_balance"][2].get<double>(), 0.93, 0.03);
    EXPECT_NEAR(found["exposure_over_frames_ev"][1].get<double>(), -0.9, 0.05);
    EXPECT_EQ(found["frames"], 12);
    EXPECT_EQ(found["tags"].size(), 4u);
    EXPECT_TRUE(found["consistent"].get<bool>());

    // A probe camera of other gain: the answer follows it.
    const json tinted = calibration({scene_with(probe_times({5.6f, 8, 16}, "tinted.exr")), "--frame", "9"});
    EXPECT_NEAR(tinted["exposure_ev"].get<double>(), found["exposure_ev"].get<double>() - 3, 0.05);
    for (int c = 0; c < 3; ++c) {
        const double gain = std::array<double, 3>{5.6, 8, 16}.at(static_cast<std::size_t>(c));
        EXPECT_NEAR(tinted["channel_ev"][c].get<double>(), found["channel_ev"][c].get<double>() - std::log2(gain),
                    0.05);
    }
}

TEST_F(ProbeCalibrateCommand, TheWrittenProbeHasTheFilmsScale) {
    const std::string scene = scene_with(sample / "probe.exr", "exposure_ev = 1");
    const std::string output = (scratch_ / "fitted.exr").string();
    const json written = calibration({scene, "--frames", "0-3", "--white-balance", "-o", output});
    EXPECT_EQ(written["file"], output);
    // The scene's own exposure of 1 EV is in it.
    EXPECT_NEAR(std::log2(written["gain"][1].get<double>()), -0.9, 0.05);
    const json again = calibration({scene_with(output), "--frames", "0-3"});
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(again["channel_ev"][c].get<double>(), 0, 0.01);
    const RunResult info = run_matchlight({"probe", "info", "--json", output});
    EXPECT_EQ(json::parse(info.standard_output)["metadata"]["calibrated_against"], "plate.mp4");
}

TEST_F(ProbeCalibrateCommand, AProbeThatIsTurnedIsToldAndHowToTurnIt) {
    const RunResult result = run_matchlight(
        {"probe", "calibrate", "--json", scene_with(sample / "probe.exr", "rotation_deg = 50"), "--frames", "0-2"});
    ASSERT_TRUE(succeeded(result));
    EXPECT_TRUE(warned_of(result, {"probe.exr", "rotation_deg"}));
    EXPECT_NEAR(json::parse(result.standard_output)["better_rotation_deg"].get<double>(), 0, 6);
}

TEST_F(ProbeCalibrateCommand, BadInputsAreNamed) {
    const fs::path study = fs::path(MATCHLIGHT_SOURCE_DIR) / "samples" / "study" / "bloom.toml";
    EXPECT_TRUE(failed_naming(run_matchlight({"probe", "calibrate", study.string()}), {"bloom.toml", "footage"}));
    const std::string scene = scene_with(sample / "probe.exr");
    EXPECT_TRUE(failed_naming(run_matchlight({"probe", "calibrate", scene, "-o", (sample / "probe.exr").string()}),
                              {"probe.exr", "own probe"}));
    EXPECT_TRUE(failed_naming(run_matchlight({"probe", "calibrate", scene, "-o", (scratch_ / "x.png").string()}),
                              {"x.png", ".exr"}));
    EXPECT_TRUE(failed_naming(run_matchlight({"probe", "calibrate", scene, "--frames", "0-1", "--frame", "5"}),
                              {"plate.mp4", "frame 5"}));
}

}  // namespace
}  // namespace matchlight::test
