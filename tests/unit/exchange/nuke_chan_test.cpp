// A .chan read back as Nuke reads it: angles, places, field of view.
#include "exchange/nuke_chan.h"

#include <sstream>

#include <gtest/gtest.h>

#include "made_solve.h"

namespace matchlight::test {
namespace {

constexpr double rad_per_deg = std::numbers::pi / 180;

Eigen::Matrix3d from_zxy_deg(const Eigen::Vector3d& deg) {
    return (Eigen::AngleAxisd(deg.y() * rad_per_deg, Eigen::Vector3d::UnitY()) *
            Eigen::AngleAxisd(deg.x() * rad_per_deg, Eigen::Vector3d::UnitX()) *
            Eigen::AngleAxisd(deg.z() * rad_per_deg, Eigen::Vector3d::UnitZ()))
        .toRotationMatrix();
}

struct ChanLine {
    std::int64_t frame = 0;
    Eigen::Vector3d place, angles_deg;
    double vertical_fov_deg = 0;
};

std::vector<ChanLine> read_chan(const std::string& text) {
    std::istringstream stream(text);
    std::vector<ChanLine> lines;
    for (std::string line; std::getline(stream, line);) {
        std::istringstream numbers(line);
        ChanLine& read = lines.emplace_back();
        numbers >> read.frame >> read.place.x() >> read.place.y() >> read.place.z() >> read.angles_deg.x() >>
            read.angles_deg.y() >> read.angles_deg.z() >> read.vertical_fov_deg;
        EXPECT_TRUE(numbers && numbers.eof()) << line;
    }
    return lines;
}

TEST(NukeChan, ProjectsTheRigAsTheSolveDoes) {
    CameraTrackOptions options;
    options.centred = true;
    options.first_number = 1001;
    const CameraTrack track = track_of(made_solve(), options);
    const std::vector<ChanLine> lines = read_chan(nuke_chan_text(track));
    ASSERT_EQ(lines.size(), 8u);  // two frames have no pose
    std::size_t at = 0;
    for (const SolvedFrame& frame : track.frames) {
        if (!frame.camera_from_world) continue;
        const ChanLine& line = lines[at++];
        EXPECT_EQ(line.frame, frame.frame);
        const double focal_px = 360 / std::tan(line.vertical_fov_deg / 2 * rad_per_deg);
        for (const Eigen::Vector3d& corner : corners_of(track.rig)) {
            // Nuke: y up, the camera looks along −z.
            const Eigen::Vector3d y_up(corner.x(), corner.z(), -corner.y());
            const Eigen::Vector3d seen = from_zxy_deg(line.angles_deg).transpose() * (y_up - line.place);
            ASSERT_LT(seen.z(), 0);
            const Eigen::Vector2d px(639.5 + focal_px * seen.x() / -seen.z(), 359.5 - focal_px * seen.y() / -seen.z());
            EXPECT_LT((px - expected_px(track, frame, corner)).norm(), agreement_px) << "frame " << frame.frame;
        }
    }
    EXPECT_EQ(lines.front().frame, 1001);
}

TEST(NukeChan, AnglesComeBackWhereTheyLock) {
    for (const double x : {-90.0, -89.9999999, -45.0, 0.0, 30.0, 89.99999, 90.0, 120.0}) {
        for (const double y : {-170.0, 0.0, 35.0}) {
            for (const double z : {-100.0, 0.0, 179.0}) {
                const Eigen::Matrix3d rotation = from_zxy_deg({x, y, z});
                const Eigen::Vector3d angles = zxy_angles_deg(rotation, Eigen::Vector3d::Zero());
                // Rounding of a rotation matrix in double precision, some times over.
                EXPECT_LT((from_zxy_deg(angles) - rotation).cwiseAbs().maxCoeff(), 1e-9) << x << " " << y << " " << z;
            }
        }
    }
}

TEST(NukeChan, AnglesRunOnWithoutJumps) {
    // Two turns about the vertical, tilting over the top on the way.
    Eigen::Vector3d before = Eigen::Vector3d::Zero();
    for (int i = 0; i <= 720; ++i) {
        const Eigen::Vector3d angles = zxy_angles_deg(from_zxy_deg({0.15 * i, 1.0 * i, 0.5 * i}), before);
        // One step; two after the frame at which x is 90° and y waits.
        EXPECT_LT((angles - before).cwiseAbs().maxCoeff(), 2.001) << i;
        before = angles;
    }
    EXPECT_NEAR(before.y(), 720, 1e-6);
    EXPECT_NEAR(before.x(), 108, 1e-6);
}

TEST(NukeChan, SaysWhatItCannotHold) {
    const CameraLimits limits{.offset = false, .pixel_aspect = false, .distortion = false};
    EXPECT_EQ(what_is_lost(track_of(made_solve()), limits).size(), 3u);
    CameraTrackOptions centred;
    centred.centred = true;
    EXPECT_EQ(what_is_lost(track_of(made_solve(), centred), limits).size(), 1u);  // the distortion
    Solve ideal = made_solve();
    ideal.camera.distortion.clear();
    EXPECT_TRUE(what_is_lost(track_of(ideal, centred), limits).empty());
    ideal.camera.lens = LensModel::fisheye;
    const auto lost = what_is_lost(track_of(ideal, centred), limits);
    ASSERT_EQ(lost.size(), 1u);
    EXPECT_NE(lost[0].find("fisheye"), std::string::npos);
}

}  // namespace
}  // namespace matchlight::test
