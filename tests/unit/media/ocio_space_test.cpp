#include "media/ocio_space.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include <Eigen/Core>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

/// ARRI's LogC3 at EI 800 (ARRI 2017, "ALEXA Log C Curve – Usage in VFX") in AWG3, by OpenColorIO's transforms.
constexpr const char* spaces = R"(
colorspaces:
  - !<ColorSpace>
    name: ACES2065-1
    isdata: false
  - !<ColorSpace>
    name: LogC3
    isdata: false
    to_scene_reference: !<GroupTransform>
      children:
        - !<LogCameraTransform> {log_side_slope: 0.247190, log_side_offset: 0.385537, lin_side_slope: 5.555556, lin_side_offset: 0.052272, lin_side_break: 0.010591, base: 10, direction: inverse}
        - !<MatrixTransform> {matrix: [0.680206, 0.236137, 0.0836574, 0, 0.0854149, 1.01747, -0.102885, 0, 0.00205676, -0.0625625, 1.06051, 0, 0, 0, 0, 1]}
  - !<ColorSpace>
    name: graded
    isdata: false
    to_scene_reference: !<GroupTransform>
      children:
        - !<CDLTransform> {sat: 0.5}
        - !<ExponentTransform> {value: [2, 2, 2, 1]}
  - !<ColorSpace>
    name: upside down
    isdata: false
    to_scene_reference: !<MatrixTransform> {matrix: [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1], offset: [1, 1, 1, 0]}
)";

class OcioSpaces : public testing::Test {
protected:
    OcioSpaces() { write("roles:\n  aces_interchange: ACES2065-1\n  default: ACES2065-1\n", spaces); }
    ~OcioSpaces() override {
        std::error_code ignored;
        fs::remove(config_, ignored);
    }
    void write(const std::string& roles, const std::string& colorspaces) const {
        std::ofstream(config_) << "ocio_profile_version: 2\n"
                               << roles
                               << "file_rules:\n  - !<Rule> {name: Default, colorspace: default}\n"
                                  "displays:\n  none:\n    - !<View> {name: raw, colorspace: default}\n"
                               << colorspaces;
    }
    std::string refusal(const std::string& space) const {
        try {
            ocio_space(config_, space);
        } catch (const InputError& error) {
            return error.what();
        }
        return "nothing was refused";
    }

    fs::path config_ = fs::temp_directory_path() / ("matchlight_spaces_" + std::to_string(getpid()) + ".ocio");
};

double light_of_logc3(double code) {
    const double a = 5.555556, b = 0.052272, c = 0.247190, d = 0.385537, cut = 0.010591;
    const double slope = c * a / ((a * cut + b) * std::numbers::ln10);
    const double code_at_cut = c * std::log10(a * cut + b) + d;
    return code > code_at_cut ? (std::pow(10, (code - d) / c) - b) / a : cut + (code - code_at_cut) / slope;
}

TEST_F(OcioSpaces, ALogSpaceBecomesItsCurveAndPrimaries) {
    const OcioSpace space = ocio_space(config_, "LogC3");
    EXPECT_TRUE((rec709_from(space.primaries).rowwise().sum() - Eigen::Vector3d::Ones()).isZero(1e-4));
    // AWG3 to Rec.709, as ARRI prints it: straight. Its way to ACES adapts the white by CAT02, the way back by
    // Bradford.
    Eigen::Matrix3d printed;
    printed << 1.617523, -0.537287, -0.080237, -0.070573, 1.334613, -0.264040, -0.021102, -0.226954, 1.248056;
    EXPECT_LT((rec709_from(space.primaries) - printed).cwiseAbs().maxCoeff(), 6e-3) << rec709_from(space.primaries);
    const double brightest = light_of_logc3(1);
    for (std::size_t i = 0; i < space.codes.size(); i += 16) {
        const double wanted = light_of_logc3(space.codes[i]) / brightest;
        for (const auto& curve : space.linear) {
            EXPECT_NEAR(curve[i], wanted, 1e-3 * std::abs(wanted) + 1e-6) << space.codes[i];
        }
    }
}

TEST_F(OcioSpaces, LinearRec709ServesWhereTheRoleIsMissing) {
    write("roles:\n  default: lin_rec709\n", R"(
colorspaces:
  - !<ColorSpace>
    name: lin_rec709
    isdata: false
  - !<ColorSpace>
    name: gamma
    isdata: false
    to_scene_reference: !<ExponentTransform> {value: [2.4, 2.4, 2.4, 1]}
)");
    const OcioSpace space = ocio_space(config_, "gamma");
    EXPECT_LT((rec709_from(space.primaries) - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-6);
    for (std::size_t i = 0; i < space.codes.size(); i += 32) {
        EXPECT_NEAR(space.linear[1][i], std::pow(space.codes[i], 2.4), 1e-5);
    }
}

TEST_F(OcioSpaces, TheConfigOfTheEnvironmentIsTaken) {
    setenv("OCIO", config_.c_str(), 1);
    EXPECT_EQ(ocio_space({}, "LogC3").primaries.name(), "LogC3");
    unsetenv("OCIO");
    EXPECT_THROW(ocio_space({}, "LogC3"), InputError);
}

TEST_F(OcioSpaces, WhatIsNoCurveAndMatrixIsRefused) {
    EXPECT_NE(refusal("graded").find("not a curve for each channel and a matrix"), std::string::npos)
        << refusal("graded");
    EXPECT_NE(refusal("upside down").find("'upside down'"), std::string::npos) << refusal("upside down");
}

TEST_F(OcioSpaces, WhatIsNotThereIsNamed) {
    const std::string unknown = refusal("LogC4");
    EXPECT_NE(unknown.find("no colour space 'LogC4'"), std::string::npos) << unknown;
    EXPECT_NE(unknown.find("LogC3"), std::string::npos) << unknown;
    write("roles:\n  default: somewhere\n",
          "colorspaces:\n  - !<ColorSpace>\n    name: somewhere\n    isdata: false\n");
    EXPECT_NE(refusal("somewhere").find("aces_interchange"), std::string::npos) << refusal("somewhere");
    std::ofstream(config_) << "not: [a config";
    EXPECT_NE(refusal("LogC3").find("no OpenColorIO config"), std::string::npos) << refusal("LogC3");
    fs::remove(config_);
    EXPECT_NE(refusal("LogC3").find(config_.filename().string()), std::string::npos) << refusal("LogC3");
}

}  // namespace
}  // namespace matchlight
