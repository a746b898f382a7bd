// Camera files of Kalibr and ROS, read and written.
#include "calibration/camera_formats.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "calibration/camera.h"
#include "core/error.h"

namespace matchlight {
namespace {

class CameraFormats : public testing::Test {
protected:
    ~CameraFormats() override { std::filesystem::remove(path_); }
    Camera read(const std::string& text) {
        std::ofstream(path_) << text;
        return load_camera(path_);
    }
    std::string error_of(const std::string& text) {
        try {
            (void)read(text);
        } catch (const InputError& error) {
            return error.what();
        }
        return {};
    }
    std::filesystem::path path_ =
        std::filesystem::temp_directory_path() / ("matchlight_formats_" + std::to_string(getpid()) + ".yaml");
};

Camera some_camera(LensModel lens, std::vector<double> distortion) {
    Camera camera;
    camera.width = 752;
    camera.height = 480;
    camera.fx = 458.654;
    camera.fy = 1372.0 / 3;
    camera.cx = 367.215;
    camera.cy = 248.375;
    camera.lens = lens;
    camera.distortion = std::move(distortion);
    return camera;
}

TEST_F(CameraFormats, ReadsKalibrsCamchain) {
    const Camera camera = read(
        "cam0:\n  T_cam_imu:\n  - [0.01, -0.99, 0.0, 0.0]\n  - [0.99, 0.01, 0.0, 0.0]\n  - [0.0, 0.0, 1.0, 0.0]\n"
        "  - [0.0, 0.0, 0.0, 1.0]\n  cam_overlaps: [1]\n  camera_model: pinhole\n"
        "  distortion_coeffs: [-0.28, 0.07, 0.00019, 1.76e-05]\n  distortion_model: radtan\n"
        "  intrinsics: [458.654, 457.296, 367.215, 248.375]\n  resolution: [752, 480]\n  rostopic: /cam0/image_raw\n"
        "cam1:\n  camera_model: pinhole\n  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]\n  distortion_model: equidistant\n"
        "  intrinsics: [1.0, 1.0, 1.0, 1.0]\n  resolution: [10, 10]\n");
    EXPECT_EQ(camera.width, 752);
    EXPECT_EQ(camera.height, 480);
    EXPECT_EQ(camera.fx, 458.654);
    EXPECT_EQ(camera.cy, 248.375);
    EXPECT_EQ(camera.lens, LensModel::radtan);
    EXPECT_EQ(camera.distortion, (std::vector<double>{-0.28, 0.07, 0.00019, 1.76e-05}));
}

TEST_F(CameraFormats, ReadsWhatRosPrintsFromATopic) {
    const Camera camera = read(
        "header:\n  seq: 0\n  frame_id: camera\nheight: 480\nwidth: 752\ndistortion_model: rational_polynomial\n"
        "D:\n- 0.1\n- 0.2\n- 0.001\n- 0.002\n- 0.3\n- 0.4\n- 0.5\n- 0.6\n"
        "K: [458.654, 0.0, 367.215, 0.0, 457.296, 248.375, 0.0, 0.0, 1.0]\nbinning_x: 0\n");
    EXPECT_EQ(camera.width, 752);
    EXPECT_EQ(camera.fy, 457.296);
    EXPECT_EQ(camera.distortion.size(), 8u);
}

TEST_F(CameraFormats, WritesWhatItReads) {
    for (const CameraFormat format : {CameraFormat::opencv, CameraFormat::kalibr, CameraFormat::ros}) {
        for (const Camera& camera : {some_camera(LensModel::radtan, {-0.28, 1.0 / 3, 1e-4, -2e-5}),
                                     some_camera(LensModel::fisheye, {0.0034, 7e-4, -2e-3, 2.0 / 3e4})}) {
            const Camera again = read(camera_text(camera, format, path_));
            EXPECT_EQ(again.width, camera.width);
            EXPECT_EQ(again.height, camera.height);
            EXPECT_EQ(again.matrix(), camera.matrix());
            EXPECT_EQ(again.lens, camera.lens);
            std::vector<double> distortion = again.distortion;
            distortion.resize(4);  // ROS' plumb_bob has a fifth, 0
            EXPECT_EQ(distortion, camera.distortion);
        }
    }
    const Camera rational = some_camera(LensModel::radtan, {0.1, 0.2, 0.001, 0.002, 0.3, 0.4, 0.5, 0.6});
    EXPECT_EQ(read(camera_text(rational, CameraFormat::ros, path_)).distortion, rational.distortion);
}

TEST_F(CameraFormats, SaysWhatAFormatCannotHold) {
    const Camera five = some_camera(LensModel::radtan, {0.1, 0.2, 0.001, 0.002, 0.3});
    EXPECT_THROW(camera_text(five, CameraFormat::kalibr, path_), InputError);
    const Camera flat = some_camera(LensModel::radtan, {0.1, 0.2, 0.001, 0.002, 0});
    EXPECT_EQ(read(camera_text(flat, CameraFormat::kalibr, path_)).distortion.size(), 4u);
    const Camera prism = some_camera(LensModel::radtan, {0.1, 0.2, 0, 0, 0.3, 0.4, 0.5, 0.6, 0.7, 0, 0, 0});
    EXPECT_THROW(camera_text(prism, CameraFormat::ros, path_), InputError);
    Camera sigmas = five;
    EXPECT_TRUE(lost_in(CameraFormat::ros, sigmas).empty());
    sigmas.sigmas = CameraSigmas{1, 1, 1, 1, {0, 0, 0, 0, 0}};
    EXPECT_FALSE(lost_in(CameraFormat::ros, sigmas).empty());
    EXPECT_TRUE(lost_in(CameraFormat::opencv, sigmas).empty());
}

TEST_F(CameraFormats, KeepsNotesThatReadersSkip) {
    CalibrationNotes notes;
    notes.model = "radtan2";
    notes.board = "chessboard 9x6 0.025";
    notes.views = 13;
    const Camera camera = some_camera(LensModel::radtan, {-0.28, 0.07, 0, 0});
    const std::string text = camera_text(camera, CameraFormat::opencv, path_, notes);
    EXPECT_NE(text.find("chessboard 9x6 0.025"), std::string::npos);
    EXPECT_EQ(read(text).distortion, camera.distortion);
}

TEST_F(CameraFormats, NamesWhatIsWrongInKalibrs) {
    const std::string good =
        "cam0:\n  camera_model: pinhole\n  distortion_model: radtan\n  intrinsics: [458.6, 457.2, 367.2, 248.3]\n"
        "  resolution: [752, 480]\n";
    EXPECT_NE(error_of(good).find("distortion_coeffs"), std::string::npos);
    EXPECT_NE(error_of(good + "  distortion_coeffs: [1, 2, 3]\n").find("4 numbers"), std::string::npos);
    EXPECT_EQ(error_of(good + "  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]\n"), "");
    EXPECT_NE(error_of("cam0:\n  camera_model: omni\n  distortion_model: radtan\n").find("omni-radtan"),
              std::string::npos);
    EXPECT_NE(error_of("cam0:\n  camera_model: pinhole\n  distortion_model: radtan\n  intrinsics: [0, 1, 1, 1]\n"
                       "  resolution: [752, 480]\n  distortion_coeffs: [0, 0, 0, 0]\n")
                  .find("focal length"),
              std::string::npos);
}

}  // namespace
}  // namespace matchlight
