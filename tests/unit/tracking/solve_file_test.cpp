// The solve file: every field survives, what is not known stays unknown, and damage is named.
#include "tracking/solve_file.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <system_error>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/atomic_file.h"
#include "core/error.h"

namespace matchlight {
namespace {

using nlohmann::json;

RigidTransform pose(double angle_rad, double x_m) {
    RigidTransform transform = RigidTransform::Identity();
    transform.linear() = Eigen::AngleAxisd(angle_rad, Eigen::Vector3d(0.6, -0.48, 0.64)).toRotationMatrix();
    transform.translation() = Eigen::Vector3d(x_m, -0.1234567890123456, 1.0 / 3);
    return transform;
}

Solve full_solve() {
    Solve solve;
    solve.footage_file = "a clip \"one\".mp4";
    solve.frame_count = 12;
    solve.camera.width = 640;
    solve.camera.height = 360;
    solve.camera.fx = 622.0 + 1.0 / 7;
    solve.camera.fy = 623;
    solve.camera.cx = 319.5;
    solve.camera.cy = 179.5;
    solve.camera.distortion = {-0.09, 0.03, 5e-4, -3e-4, 0};
    solve.rig = {{0, 0.08, RigidTransform::Identity()}, {7, 0.06, pose(0.3, 0.2)}};
    solve.response = Response::gamma(2.2);
    solve.vignette = {-0.11, 0.02};
    solve.noise = {0.001, 0.0004};
    solve.noise_neighbour_correlation = 0.31;
    solve.provenance = "matchlight test";
    SolvedFrame full;
    full.frame = 0;
    full.camera_from_world = pose(1.1, 0.4);
    full.covariance = Eigen::Matrix<double, 6, 6>::Identity() * 1e-6;
    (*full.covariance)(0, 5) = -3.25e-9;
    full.reprojection_px = 0.05;
    full.tags = {0, 7};
    full.exposure_ev = -0.9;
    full.white_balance = {1.06, 1, 0.93};
    full.focus_distance_m = 0.58;
    full.coc_scale_px_m = 12.1;
    full.shutter_fraction = 0.0;
    full.pose_confidence = 1;
    full.exposure_confidence = 0.9;
    full.focus_confidence = 0.8;
    SolvedFrame lost;
    lost.frame = 3;
    lost.time_s = 0.125;
    solve.frames = {full, lost};
    return solve;
}

class SolveFile : public testing::Test {
protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() / ("matchlight_solve_" + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
        path_ = folder_ / "clip.solve.json";
    }
    void TearDown() override {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    /// What loading says of the full solve after `change` has been at its JSON.
    template <class Change>
    std::string error_after(Change change) const {
        save_solve(path_, full_solve());
        json file = json::parse(read_text_file(path_));
        change(file);
        return error_of(file.dump());
    }
    std::string error_of(const std::string& text) const {
        std::ofstream(path_) << text;
        try {
            load_solve(path_);
        } catch (const InputError& error) {
            return error.what();
        }
        return "accepted";
    }
    std::filesystem::path folder_, path_;
};

TEST_F(SolveFile, EveryFieldSurvivesToTheLastBit) {
    const Solve solve = full_solve();
    save_solve(path_, solve);
    const Solve again = load_solve(path_);
    EXPECT_EQ(again.footage_file, solve.footage_file);
    EXPECT_EQ(again.frame_count, 12);
    EXPECT_EQ(again.camera.width, 640);
    EXPECT_EQ(again.camera.height, 360);
    EXPECT_EQ(again.camera.matrix(), solve.camera.matrix());
    EXPECT_EQ(again.camera.distortion, solve.camera.distortion);
    EXPECT_EQ(again.camera.lens, LensModel::radtan);
    ASSERT_EQ(again.rig.size(), 2u);
    EXPECT_EQ(again.rig[1].id, 7);
    EXPECT_EQ(again.rig[1].size_m, 0.06);
    EXPECT_EQ(again.rig[1].world_from_tag.matrix(), solve.rig[1].world_from_tag.matrix());
    EXPECT_EQ(again.response.family(), Response::Family::gamma);
    EXPECT_EQ(again.response.linear_from_code(0.3, 1), solve.response.linear_from_code(0.3, 1));
    EXPECT_EQ(again.vignette, solve.vignette);
    EXPECT_EQ(again.noise, solve.noise);
    EXPECT_EQ(again.noise_neighbour_correlation, solve.noise_neighbour_correlation);
    EXPECT_EQ(again.provenance, solve.provenance);
    ASSERT_EQ(again.frames.size(), 2u);
    const SolvedFrame &full = again.frames[0], &expected = solve.frames[0];
    EXPECT_EQ(full.camera_from_world->matrix(), expected.camera_from_world->matrix());
    EXPECT_EQ(*full.covariance, *expected.covariance);
    EXPECT_EQ(full.reprojection_px, expected.reprojection_px);
    EXPECT_EQ(full.tags, expected.tags);
    EXPECT_EQ(full.exposure_ev, expected.exposure_ev);
    EXPECT_EQ(full.white_balance, expected.white_balance);
    EXPECT_EQ(full.focus_distance_m, expected.focus_distance_m);
    EXPECT_EQ(full.coc_scale_px_m, expected.coc_scale_px_m);
    EXPECT_EQ(full.shutter_fraction, expected.shutter_fraction);
    EXPECT_EQ(full.pose_confidence, expected.pose_confidence);
    EXPECT_EQ(full.exposure_confidence, expected.exposure_confidence);
    EXPECT_EQ(full.focus_confidence, expected.focus_confidence);
}

TEST_F(SolveFile, WhatIsNotKnownStaysUnknown) {
    save_solve(path_, full_solve());
    const SolvedFrame lost = load_solve(path_).frames[1];
    EXPECT_EQ(lost.frame, 3);
    EXPECT_EQ(lost.time_s, 0.125);
    EXPECT_FALSE(lost.camera_from_world || lost.covariance || lost.reprojection_px || lost.exposure_ev);
    EXPECT_FALSE(lost.white_balance || lost.focus_distance_m || lost.coc_scale_px_m || lost.shutter_fraction);
    EXPECT_FALSE(lost.pose_confidence || lost.exposure_confidence || lost.focus_confidence);
    // A lost pose is written as null, other unknowns are left out.
    const json frame = json::parse(read_text_file(path_))["frames"][1];
    EXPECT_TRUE(frame["camera_from_world"].is_null());
    EXPECT_EQ(frame.size(), 3u);
}

TEST_F(SolveFile, KeysAreThoseOfTheInterface) {
    save_solve(path_, full_solve());
    const json file = json::parse(read_text_file(path_));
    EXPECT_EQ(file["matchlight_solve"], 1);
    EXPECT_EQ(file["footage"]["frames"], 12);
    EXPECT_EQ(file["lens"]["model"], "radtan");
    EXPECT_EQ(file["lens"]["camera_matrix"][0][2], 319.5);
    EXPECT_EQ(file["rig"][1]["world_from_tag"][3][3], 1);
    EXPECT_EQ(file["photometry"]["noise"]["read"], 0.001);
    EXPECT_EQ(file["photometry"]["noise"]["neighbour_correlation"], 0.31);
    EXPECT_EQ(file["frames"][0]["confidence"]["focus"], 0.8);
    EXPECT_EQ(file["frames"][0]["covariance"].size(), 6u);
}

TEST_F(SolveFile, ReadsTheLeastThereCanBe) {
    std::ofstream(path_) << R"({"matchlight_solve": 1, "footage": {"width": 8, "height": 4},
        "lens": {"camera_matrix": [[5, 0, 3.5], [0, 5, 1.5], [0, 0, 1]]}, "written_by": "something else",
        "frames": [{"frame": 2}, {"frame": 5, "camera_from_world": null, "white_balance": null}]})";
    const Solve solve = load_solve(path_);
    EXPECT_EQ(solve.frame_count, 6);
    EXPECT_EQ(solve.response.family(), Response::Family::srgb);
    EXPECT_FALSE(solve.vignette || solve.noise);
    EXPECT_NE(solve.find(5), nullptr);
    EXPECT_EQ(solve.find(5)->frame, 5);
    EXPECT_EQ(solve.find(3), nullptr);
    EXPECT_EQ(solve.find(6), nullptr);
}

TEST_F(SolveFile, DamageIsNamed) {
    const auto expect_error = [](const std::string& error, const std::string& part) {
        EXPECT_NE(error.find(part), std::string::npos) << error;
        EXPECT_NE(error.find("clip.solve.json"), std::string::npos) << error;
        EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    };
    expect_error(error_of(""), "no solve file");
    expect_error(error_of("[1, 2]"), "no solve file");
    expect_error(error_of("{\"frames\": []}"), "no solve file");
    expect_error(error_of(std::string(100000, '[')), "too deep");
    expect_error(error_after([](json& f) { f["matchlight_solve"] = 2; }), "version 2");
    expect_error(error_after([](json& f) { f.erase("lens"); }), "no \"lens\"");
    expect_error(error_after([](json& f) { f["lens"]["camera_matrix"][0][0] = 0; }), "focal length");
    expect_error(error_after([](json& f) { f["lens"]["distortion"] = {1, 2, 3}; }), "3 coefficients");
    expect_error(error_after([](json& f) { f["footage"]["width"] = 1e9; }), "width");
    expect_error(error_after([](json& f) { f["footage"]["frames"] = 2; }), "fewer frames");
    expect_error(error_after([](json& f) { f["rig"][0]["size_m"] = -1; }), "tag 0");
    expect_error(error_after([](json& f) { f["photometry"]["response"] = "log"; }), "not known");
    expect_error(error_after([](json& f) { f["photometry"]["noise"]["neighbour_correlation"] = 1.5; }), "from -1 to 1");
    expect_error(error_after([](json& f) { f["frames"][1]["frame"] = 0; }), "ascending");
    // Errors of a frame name it: the second entry is frame 3.
    expect_error(error_after([](json& f) { f["frames"][1]["exposure_ev"] = "bright"; }), "frame 3");
    expect_error(error_after([](json& f) { f["frames"][1]["camera_from_world"] = {1, 2}; }), "4 × 4");
    expect_error(error_after([](json& f) { f["frames"][0]["camera_from_world"][0][0] = 2; }), "no rotation");
    expect_error(error_after([](json& f) { f["frames"][0]["white_balance"] = {1, 0, 1}; }), "not positive");
    save_solve(path_, full_solve());
    std::string text = read_text_file(path_);
    text.replace(text.find("-0.9,"), 5, "1e999,");
    expect_error(error_of(text), "no solve file");
}

TEST_F(SolveFile, RefusesToWriteWhatJsonCannotHold) {
    Solve solve = full_solve();
    solve.frames[0].exposure_ev = std::numeric_limits<double>::infinity();
    EXPECT_THROW(save_solve(path_, solve), InputError);
    EXPECT_FALSE(std::filesystem::exists(path_));
    solve.frames[0].exposure_ev = 0;
    solve.frames[0].camera_from_world->translation().x() = std::nan("");
    EXPECT_THROW(save_solve(path_, solve), InputError);
}

}  // namespace
}  // namespace matchlight
