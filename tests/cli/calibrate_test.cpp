// matchlight calibrate: photographs in, a camera file and its page out; conversions; what is refused.
#include <algorithm>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/persistence.hpp>

#include "../unit/calibration/synthetic_board.h"
#include "calibration/camera.h"
#include "media/image_io.h"
#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* small_board = "chessboard 7x5 0.03";

Camera small_camera() {
    Camera camera;
    camera.width = 400;
    camera.height = 300;
    camera.fx = camera.fy = 330;
    camera.cx = 203;
    camera.cy = 147;
    camera.distortion = {-0.2, 0.05, 0, 0};
    return camera;
}

class CalibrateTest : public CommandTest {
protected:
    /// photo_00.png and on, as the camera above takes them.
    void photograph(int count, double most_tilt_deg = 45) {
        const BoardSpec board = read_board(small_board);
        const Camera camera = small_camera();
        fs::create_directory(scratch_ / "photos");
        int taken = 0;
        for (const RigidTransform& pose : board_poses(board, camera, 10 * count, most_tilt_deg)) {
            const LensData seen = synthetic_corners(board, {camera, {}}, {pose}, 0);
            if (taken == count || !whole(seen.views[0], camera)) continue;
            write_png8(numbered(scratch_ / "photos/photo_%02d.png", taken++), board_photograph(board, camera, pose));
        }
        ASSERT_EQ(taken, count);
    }
    /// Whether all corners are seen, with a square around each.
    static bool whole(const LensView& view, const Camera& camera) {
        constexpr double square_px = 30;
        return view.corners.size() == 35 && std::ranges::all_of(view.corners, [&](const BoardCorner& corner) {
                   return corner.px.minCoeff() > square_px && corner.px.x() < camera.width - square_px &&
                          corner.px.y() < camera.height - square_px;
               });
    }
    RunResult calibrate(std::vector<std::string> more) {
        std::vector<std::string> arguments = {"--json", "-q", "calibrate"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_matchlight(arguments);
    }
    std::string photos() const { return (scratch_ / "photos").string(); }
    fs::path output() const { return scratch_ / "camera.yaml"; }
};

TEST_F(CalibrateTest, FindsTheLensOfPhotographs) {
    photograph(8);
    const RunResult result = calibrate({photos(), "--board", small_board, "-o", output().string(), "--against-opencv"});
    ASSERT_TRUE(succeeded(result));
    const json found = json::parse(result.standard_output);
    const Camera truth = small_camera(), camera = load_camera(output());
    ASSERT_TRUE(camera.sigmas.has_value());
    EXPECT_NEAR(camera.fx, truth.fx, 4 * camera.sigmas->fx);
    EXPECT_NEAR(camera.cx, truth.cx, 4 * camera.sigmas->cx);
    EXPECT_NEAR(camera.fx, truth.fx, 0.005 * truth.fx);
    EXPECT_LT(found["rms_px"], 0.06);
    EXPECT_EQ(found["views"].size(), 8u);
    EXPECT_EQ(found["compared"].size(), 2u);
    // OpenCV reads the file and skips what it does not know.
    const cv::FileStorage file(output().string(), cv::FileStorage::READ);
    cv::Mat k;
    file["camera_matrix"] >> k;
    EXPECT_EQ(k.at<double>(0, 0), camera.fx);
    EXPECT_EQ(file["board"].string(), small_board);
    EXPECT_NE(bytes_of(scratch_ / "camera.html").find("</html>"), std::string::npos);

    // A second run does not replace them unasked; a pattern names the same photographs, another place the page.
    EXPECT_TRUE(failed_naming(calibrate({photos(), "--board", small_board, "-o", output().string()}),
                              {"camera.yaml", "exists"}));
    const fs::path kalibr = scratch_ / "kalibr.yaml", page = scratch_ / "page";
    ASSERT_TRUE(succeeded(calibrate({photos() + "/photo_%02d.png", "--board", small_board, "-o", kalibr.string(),
                                     "--format", "kalibr", "--report", page.string()})));
    EXPECT_EQ(load_camera(kalibr).distortion.size(), 4u);
    EXPECT_TRUE(fs::exists(page / "index.html"));
}

TEST_F(CalibrateTest, ConvertsCameraFiles) {
    const fs::path from = fs::path(MATCHLIGHT_SOURCE_DIR) / "calib/cameras/handheld_1920x1080.yaml";
    const fs::path ros = scratch_ / "ros.yaml";
    ASSERT_TRUE(succeeded(calibrate({"--from", from.string(), "--format", "ros", "-o", ros.string()})));
    EXPECT_EQ(load_camera(ros).matrix(), load_camera(from).matrix());
    EXPECT_EQ(load_camera(ros).distortion, load_camera(from).distortion);
    const fs::path kalibr = scratch_ / "kalibr.yaml";  // five coefficients are one too many for it
    EXPECT_TRUE(failed_naming(calibrate({"--from", from.string(), "--format", "kalibr", "-o", kalibr.string()}),
                              {"kalibr.yaml", "radial"}));
    EXPECT_TRUE(nothing_left_of(kalibr));
    EXPECT_TRUE(failed_naming(calibrate({"--from", ros.string(), "-o", ros.string(), "--overwrite"}), {"input"}));
}

TEST_F(CalibrateTest, RefusesWhatIsNoCalibration) {
    photograph(4, 0.3);
    const auto refused = [&](const std::vector<std::string>& inputs, const std::string& board,
                             const std::vector<std::string>& words) {
        std::vector<std::string> arguments = inputs;
        arguments.insert(arguments.end(), {"--board", board, "-o", output().string()});
        EXPECT_TRUE(failed_naming(calibrate(arguments), words));
        EXPECT_TRUE(nothing_left_of(output()));
        EXPECT_TRUE(nothing_left_of(scratch_ / "camera.html"));
    };
    refused({photos()}, small_board, {"photos", "focal length", "tilted"});
    refused({photos()}, "chessboard 9x6 0.03", {"none of 4 photographs", "9 × 6"});
    refused({photos()}, "charuco 5x4 0.03 0.02 DICT_4X4_50", {"none of 4 photographs", "ChArUco"});
    refused({photos() + "/photo_00.png"}, small_board, {"photo_00.png", "at least 4 views", "there is 1"});
    refused({photos()}, "chessboard 9x6 nan", {"length"});
    refused({photos()}, "no_such_board.toml", {"neither"});
    refused({(scratch_ / "nothing_%04d.png").string()}, small_board, {"nothing_%04d.png"});
    refused({(scratch_ / "nothing*.png").string()}, small_board, {"nothing*.png"});
    refused({scratch_.write("broken.mp4", "no video").string()}, small_board, {"broken.mp4"});
    write_png8(scratch_ / "photos/photo_04.png", Image8(300, 400, 3, 200));
    refused({photos()}, small_board, {"photo_04.png", "300×400", "400×300"});
    fs::create_directory(scratch_ / "empty");
    refused({(scratch_ / "empty").string()}, small_board, {"holds no pictures"});
    EXPECT_TRUE(failed_naming(calibrate({photos(), "--board", small_board, "-o", "/no/such/folder/camera.yaml"}),
                              {"/no/such/folder"}));
    EXPECT_TRUE(refused_call(calibrate({photos(), "-o", output().string()})));
    EXPECT_TRUE(refused_call(calibrate({"--board", small_board, "-o", output().string()})));
}

using CalibrateDataTest = SharedDataTest;

/// Root mean squares of `calibrate --against-opencv`: ours, then OpenCV's from its own corners.
struct Compared {
    json found;
    double opencv_rms_px = 0, opencv_held_out_px = 0;
};

Compared compared_with_opencv(const std::vector<std::string>& inputs, const std::string& board,
                              const fs::path& output) {
    std::vector<std::string> arguments = {"--json", "-q", "calibrate"};
    arguments.insert(arguments.end(), inputs.begin(), inputs.end());
    arguments.insert(arguments.end(), {"--board", board, "-o", output.string(), "--against-opencv"});
    const RunResult result = run_matchlight(arguments);
    EXPECT_TRUE(succeeded(result));
    Compared compared{json::parse(result.standard_output), 0, 0};
    compared.opencv_rms_px = compared.found["compared"][0]["rms_px"];
    compared.opencv_held_out_px = compared.found["compared"][0]["held_out_rms_px"];
    return compared;
}

TEST_F(CalibrateDataTest, IsBetterThanOpenCvOnItsOwnPhotographs) {
    const fs::path folder = data_ / "real/calib/opencv_stereo_chess";
    if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not there";
    for (const auto& [side, known_rms_px] : {std::pair{"left", 0.196}, {"right", 0.207}}) {
        const Compared compared =
            compared_with_opencv({(folder / (std::string(side) + "*.jpg")).string()}, "chessboard 9x6 0.025",
                                 scratch_ / (std::string(side) + ".yaml"));
        EXPECT_EQ(compared.found["views"].size(), 13u);
        EXPECT_LE(compared.found["rms_px"], known_rms_px);
        EXPECT_LE(compared.found["rms_px"], compared.opencv_rms_px);
        EXPECT_LT(compared.found["held_out_rms_px"], compared.opencv_held_out_px);
    }
}

TEST_F(CalibrateDataTest, FindsAFisheyeLensFromFiveAprilgrids) {
    const fs::path folder = data_ / "real/calib/aprilgrid_rs";
    if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not there";
    std::vector<std::string> photographs;
    for (const char* name : {"TUM_VI", "r45", "right", "top", "top_right"}) {
        photographs.push_back((folder / (std::string(name) + ".png")).string());
    }
    const Compared compared = compared_with_opencv(photographs, "aprilgrid 6x6 0.088 0.3", scratch_ / "fisheye.yaml");
    EXPECT_EQ(compared.found["model"], "fisheye");
    EXPECT_LT(compared.found["held_out_rms_px"], 0.15);
    // The published calibration of that camera (TUM VI, camera 0 at 1024 × 1024): 381 px, centre (510.3, 514.3).
    const json& parameters = compared.found["parameters"];
    EXPECT_NEAR(parameters["fx"]["value"], 380.8, 3 * parameters["fx"]["sigma"].get<double>());
    EXPECT_NEAR(parameters["cx"]["value"], 510.3, 3 * parameters["cx"]["sigma"].get<double>());
    EXPECT_NEAR(parameters["cy"]["value"], 514.3, 3 * parameters["cy"]["sigma"].get<double>());
}

}  // namespace
}  // namespace matchlight::test
