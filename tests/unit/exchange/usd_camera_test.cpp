// The .usda read back line by line, and projected as USD's cameras do.
#include "exchange/usd_camera.h"

#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "made_solve.h"

namespace matchlight::test {
namespace {

/// The number after "NAME = ".
double value_of(const std::string& text, const std::string& name) {
    const std::size_t at = text.find(name + " = ");
    EXPECT_NE(at, std::string::npos) << name;
    return std::stod(text.substr(at + name.size() + 3));
}

/// The lines of "NAME.timeSamples = { … }", by frame.
std::map<int, std::string> samples_of(const std::string& text, const std::string& name) {
    std::map<int, std::string> samples;
    const std::size_t at = text.find(name + ".timeSamples = {");
    if (at == std::string::npos) return samples;
    std::istringstream stream(text.substr(text.find('\n', at) + 1));
    for (std::string line; std::getline(stream, line) && line.find('}') == std::string::npos;) {
        const std::size_t colon = line.find(':');
        samples[std::stoi(line.substr(0, colon))] = line.substr(colon + 2, line.rfind(',') - colon - 2);
    }
    return samples;
}

/// Sixteen numbers in USD's order; row vectors stand on the left of its matrices.
Eigen::Matrix4d matrix_of(std::string text) {
    for (char& c : text) {
        if (c == '(' || c == ')' || c == ',') c = ' ';
    }
    std::istringstream numbers(text);
    Eigen::Matrix4d matrix;
    for (int i = 0; i < 16; ++i) numbers >> matrix(i % 4, i / 4);
    EXPECT_TRUE(static_cast<bool>(numbers));
    return matrix;
}

TEST(UsdCamera, ProjectsTheRigAsTheSolveDoes) {
    const CameraTrack track = track_of(made_solve());
    const std::string text = usd_camera_text(track);
    ASSERT_TRUE(text.starts_with("#usda 1.0\n"));
    EXPECT_EQ(value_of(text, "metersPerUnit"), 0.01);
    const double focal = value_of(text, "focalLength");
    const double right = value_of(text, "horizontalAperture") / 2, up = value_of(text, "verticalAperture") / 2;
    const double shift_x = value_of(text, "horizontalApertureOffset");
    const double shift_y = value_of(text, "verticalApertureOffset");
    EXPECT_NEAR(2 * right, 36, 1e-9);
    const auto matrices = samples_of(text, "matrix4d xformOp:transform");
    ASSERT_EQ(matrices.size(), 10u);
    for (const SolvedFrame& frame : track.frames) {
        if (!frame.camera_from_world) continue;
        const Eigen::Matrix4d world_from_camera = matrix_of(matrices.at(static_cast<int>(frame.frame)));
        for (const Eigen::Vector3d& corner : corners_of(track.rig)) {
            const Eigen::Vector3d corner_cm = corner * 100;
            const Eigen::Vector4d seen = world_from_camera.inverse() * corner_cm.homogeneous();
            // The frustum of GfCamera: its window runs over offset ± half an aperture at the focal length.
            const double across = (seen.x() / -seen.z() * focal - shift_x + right) / (2 * right);
            const double down = (up + shift_y - seen.y() / -seen.z() * focal) / (2 * up);
            const Eigen::Vector2d px(across * track.pinhole.width - 0.5, down * track.pinhole.height - 0.5);
            EXPECT_LT((px - expected_px(track, frame, corner)).norm(), agreement_px) << "frame " << frame.frame;
        }
    }
}

TEST(UsdCamera, TagsStandWhereTheyAre) {
    const Solve solve = made_solve();
    const std::string text = usd_camera_text(track_of(solve));
    const std::string mesh = text.substr(text.find("def Mesh \"tag_7\""));
    Eigen::Matrix4d pose = matrix_of(mesh.substr(mesh.find("xformOp:transform = ") + 20));
    pose.topRightCorner<3, 1>() /= 100;
    EXPECT_LT((pose - solve.rig[1].world_from_tag.matrix()).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_NE(mesh.find("points = [(-2.5, -2.5, 0), (2.5, -2.5, 0), (2.5, 2.5, 0), (-2.5, 2.5, 0)]"),
              std::string::npos);
}

TEST(UsdCamera, WithoutAPoseItWaitsUnseen) {
    const std::string text = usd_camera_text(track_of(made_solve()));
    const auto seen = samples_of(text, "token visibility");
    EXPECT_EQ(seen.at(3), "\"inherited\"");
    EXPECT_EQ(seen.at(4), "\"invisible\"");
    EXPECT_EQ(seen.at(6), "\"inherited\"");
    const auto matrices = samples_of(text, "matrix4d xformOp:transform");
    EXPECT_EQ(matrices.at(3), matrices.at(5));
    Solve whole = made_solve();
    whole.frames[4] = whole.frames[5] = whole.frames[3];
    whole.frames[4].frame = 4;
    whole.frames[4].time_s = 4 / 24.0;
    whole.frames[5].frame = 5;
    whole.frames[5].time_s = 5 / 24.0;
    EXPECT_TRUE(samples_of(usd_camera_text(track_of(whole)), "token visibility").empty());
}

TEST(UsdCamera, HoldsTheOptics) {
    CameraTrackOptions options;
    options.sensor_width_mm = 1280 * 25.0 / 900;  // 900 px are 25 mm
    const std::string text = usd_camera_text(track_of(made_solve(), options));
    EXPECT_NEAR(value_of(text, "focalLength"), 25, 1e-9);
    EXPECT_EQ(std::stod(samples_of(text, "float focusDistance").at(0)), 60);  // cm
    EXPECT_NEAR(std::stod(samples_of(text, "float fStop").at(0)), 2, 1e-9);   // 25 mm over 12.5 mm
    EXPECT_EQ(samples_of(text, "double shutter:open").at(9), "-0.25");
    EXPECT_EQ(samples_of(text, "double shutter:close").at(9), "0.25");
    EXPECT_EQ(samples_of(text, "float exposure").count(4), 0u);  // not known there
    EXPECT_NEAR(std::stod(samples_of(text, "float exposure").at(6)), -0.4, 1e-9);
    Solve plain = made_solve();
    for (SolvedFrame& frame : plain.frames) frame.focus_distance_m = frame.coc_scale_px_m = std::nullopt;
    const std::string without = usd_camera_text(track_of(plain));
    EXPECT_EQ(without.find("focusDistance"), std::string::npos);
    EXPECT_EQ(without.find("fStop"), std::string::npos);
}

TEST(UsdCamera, NamesOfFootageStayInsideTheirQuotes) {
    Solve solve = made_solve();
    solve.footage_file = "a\"b\\c\nd.mp4";
    EXPECT_NE(usd_camera_text(track_of(solve)).find("camera of a\\\"b\\\\c?d.mp4\"\n"), std::string::npos);
}

}  // namespace
}  // namespace matchlight::test
