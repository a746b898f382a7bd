// Camera files: what OpenCV and ROS write is read; what is wrong in one is named.
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include <gtest/gtest.h>
#include <unistd.h>

#include "calibration/camera.h"
#include "core/error.h"

namespace matchlight {
namespace {

class CameraFile : public testing::Test {
protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() / ("matchlight_camera_" + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
        path_ = folder_ / "camera.yaml";
    }
    void TearDown() override {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    void write(const std::string& text) const { std::ofstream(path_) << text; }
    std::string error_of(const std::string& text) const {
        write(text);
        try {
            load_camera(path_);
        } catch (const InputError& error) {
            return error.what();
        }
        return "accepted";
    }

    std::filesystem::path folder_, path_;
};

std::string opencv_yaml(const std::string& matrix, const std::string& distortion, int count) {
    return "%YAML:1.0\n---\nimage_width: 640\nimage_height: 360\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: "
           "3\n"
           "   dt: d\n   data: [ " +
           matrix + " ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: " + std::to_string(count) +
           "\n   dt: d\n   data: [ " + distortion + " ]\n";
}

const std::string good_matrix = "622.5, 0., 319.5, 0., 623.25, 179.5, 0., 0., 1.";

TEST_F(CameraFile, ReadsOpencvsYaml) {
    write(opencv_yaml(good_matrix, "-0.09, 0.03, 5.0e-04, -3.0e-04, 0.", 5));
    const Camera camera = load_camera(path_);
    EXPECT_EQ(camera.width, 640);
    EXPECT_EQ(camera.height, 360);
    EXPECT_EQ(camera.fx, 622.5);
    EXPECT_EQ(camera.fy, 623.25);
    EXPECT_EQ(camera.cx, 319.5);
    EXPECT_EQ(camera.cy, 179.5);
    EXPECT_EQ(camera.lens, LensModel::radtan);
    EXPECT_EQ(camera.distortion, (std::vector<double>{-0.09, 0.03, 5e-4, -3e-4, 0}));
}

TEST_F(CameraFile, ReadsRosYamlWithoutAHeader) {
    write(
        "image_width: 640\nimage_height: 480\ncamera_name: narrow\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
        "  data: [500, 0, 320, 0, 501, 240, 0, 0, 1]\ndistortion_model: plumb_bob\ndistortion_coefficients:\n"
        "  rows: 1\n  cols: 5\n  data: [-0.1, 0.01, 0, 0, 0]\n");
    const Camera camera = load_camera(path_);
    EXPECT_EQ(camera.fy, 501);
    EXPECT_EQ(camera.distortion.size(), 5u);
}

TEST_F(CameraFile, ReadsJson) {
    path_ = folder_ / "camera.json";
    write(
        "{\"image_width\": 640, \"image_height\": 480, \"camera_matrix\": [[500, 0, 320], [0, 501, 240], [0, 0, 1]],"
        " \"camera_model\": \"fisheye\", \"distortion_coefficients\": [0.1, 0.2, 0.3, 0.4]}");
    const Camera camera = load_camera(path_);
    EXPECT_EQ(camera.lens, LensModel::fisheye);
    EXPECT_EQ(camera.cx, 320);
    EXPECT_EQ(camera.distortion.size(), 4u);
}

TEST_F(CameraFile, WritesWhatItReads) {
    Camera camera;
    camera.width = 1920;
    camera.height = 1080;
    camera.fx = 1234.5678901234567;
    camera.fy = 1e3 / 3;
    camera.cx = 959.5;
    camera.cy = 539.25;
    for (const LensModel lens : {LensModel::radtan, LensModel::fisheye}) {
        for (const auto& distortion : {std::vector<double>{}, std::vector<double>{1.0 / 3, -0.07, 1e-5, -2e-9}}) {
            camera.lens = lens;
            camera.distortion = distortion;
            save_camera(path_, camera);
            const Camera again = load_camera(path_);
            EXPECT_EQ(again.width, camera.width);
            EXPECT_EQ(again.height, camera.height);
            EXPECT_EQ(again.matrix(), camera.matrix());
            EXPECT_EQ(again.lens, camera.lens);
            EXPECT_EQ(again.distortion, camera.distortion);
        }
    }
}

TEST_F(CameraFile, KeepsSigmas) {
    Camera camera;
    camera.width = 1920;
    camera.height = 1080;
    camera.fx = camera.fy = 1500;
    camera.distortion = {0.1, -0.2, 0, 0, 0.05};
    save_camera(path_, camera);
    EXPECT_FALSE(load_camera(path_).sigmas.has_value());
    camera.sigmas = {1.25, 1.5, 0.75, 1.0 / 3, {1e-3, 2e-3, 1e-4, 2e-4, 3e-2}};
    save_camera(path_, camera);
    const Camera again = load_camera(path_);
    ASSERT_TRUE(again.sigmas.has_value());
    EXPECT_EQ(again.sigmas->fx, 1.25);
    EXPECT_EQ(again.sigmas->fy, 1.5);
    EXPECT_EQ(again.sigmas->cx, 0.75);
    EXPECT_EQ(again.sigmas->cy, 1.0 / 3);
    EXPECT_EQ(again.sigmas->distortion, camera.sigmas->distortion);
    // A proxy's pixels are larger, its coefficients the same.
    const Camera half = camera_for_size(again, 960, 540, "clip.mp4");
    EXPECT_EQ(half.sigmas->fx, 0.625);
    EXPECT_EQ(half.sigmas->distortion, camera.sigmas->distortion);
}

TEST(ReadyCameras, AllLoadAndReachTheirWholePicture) {
    int cameras = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(MATCHLIGHT_SOURCE_DIR) / "calib" / "cameras")) {
        const Camera camera = load_camera(entry.path());
        ++cameras;
        for (const double x : {0.0, camera.width - 1.0}) {
            for (const double y : {0.0, camera.height - 1.0}) {
                EXPECT_TRUE(camera.normalized_from_pixel({x, y}).allFinite()) << entry.path();
            }
        }
    }
    EXPECT_GE(cameras, 1);
}

TEST_F(CameraFile, NamesWhatIsWrong) {
    const std::string five = "0., 0., 0., 0., 0.";
    const auto expect_error = [&](const std::string& text, const std::string& part) {
        const std::string error = error_of(text);
        EXPECT_NE(error.find(part), std::string::npos) << error;
        EXPECT_NE(error.find("camera.yaml"), std::string::npos) << error;
        EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    };
    expect_error(opencv_yaml("0., 0., 319.5, 0., 623., 179.5, 0., 0., 1.", five, 5), "focal length");
    expect_error(opencv_yaml("-622., 0., 319.5, 0., 623., 179.5, 0., 0., 1.", five, 5), "focal length");
    expect_error(opencv_yaml(".Nan, 0., 319.5, 0., 623., 179.5, 0., 0., 1.", five, 5), "not finite");
    expect_error(opencv_yaml(good_matrix, "0., .Inf, 0., 0., 0.", 5), "not finite");
    expect_error(opencv_yaml(good_matrix, "0., 0., 0.", 3), "3 distortion_coefficients");
    expect_error(opencv_yaml("622., 1., 319.5, 0., 623., 179.5, 0., 0., 1.", five, 5), "skew");
    expect_error("%YAML:1.0\n---\nimage_width: 640\nimage_height: 360\n", "camera_matrix");
    expect_error("%YAML:1.0\n---\nimage_width: 640\n", "image_height");
    expect_error("%YAML:1.0\n---\nimage_width: -640\nimage_height: 360\n", "picture size");
    expect_error("%YAML:1.0\n---\nimage_width: 640\nimage_height: 360\ncamera_matrix: [1, 2, 3]\n", "3 × 3");
    const std::string good = opencv_yaml(good_matrix, five, 5);
    expect_error(good + "parameter_sigmas: [1, 1, 1, 1]\n", "parameter_sigmas");
    expect_error(good + "parameter_sigmas: [1, 1, -1, 1, 0, 0, 0, 0, 0]\n", "negative");
    expect_error("", "no");
    expect_error(std::string("\x00\x01\xff\xfe garbage", 12), "no");
    std::filesystem::remove(path_);
    EXPECT_THROW(load_camera(path_), InputError);
}

}  // namespace
}  // namespace matchlight
