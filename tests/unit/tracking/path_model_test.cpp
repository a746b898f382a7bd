// Smoothing that lowers jitter and moves no motion.
#include "tracking/path_model.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "synthetic_view.h"

namespace matchlight {
namespace {

using Motion = std::function<RigidTransform(double)>;
constexpr double frame_s = 1 / 24.0;
constexpr double turn_sigma = 2e-4, shift_sigma_m = 1e-4;

/// Poses of `motion` with noise on the world side; absent where `shows` says so.
std::vector<PathMeasurement> measured(const Motion& motion, int frames, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<PathMeasurement> result;
    for (int f = 0; f < frames; ++f) {
        Eigen::Matrix<double, 6, 1> noise, sigma;
        sigma << Eigen::Vector3d::Constant(turn_sigma), Eigen::Vector3d::Constant(shift_sigma_m);
        for (int i = 0; i < 6; ++i) noise[i] = sigma[i] * normal(random);
        PathMeasurement& measurement = result.emplace_back();
        measurement.time_s = f * frame_s;
        measurement.camera_from_world = perturbed(motion(f * frame_s), noise);
        measurement.covariance = sigma.cwiseAbs2().asDiagonal();
    }
    return result;
}

/// RMS error in units of the measurements' standard deviation, 1 without smoothing.
double relative_error(const SmoothPath& path, const Motion& motion, int first, int last) {
    double sum = 0;
    for (int f = first; f <= last; ++f) {
        const auto error =
            perturbation_between(motion(f * frame_s), path.poses[static_cast<std::size_t>(f)]->camera_from_world);
        sum += (error.head<3>() / turn_sigma).squaredNorm() + (error.tail<3>() / shift_sigma_m).squaredNorm();
    }
    return std::sqrt(sum / (6 * (last - first + 1)));
}

/// The error that stays when the noise is averaged out over many clips: what smoothing itself does to the motion.
double relative_bias(const Motion& motion, int frames, int first, int last) {
    constexpr int clips = 25;
    std::vector<Eigen::Matrix<double, 6, 1>> sums(static_cast<std::size_t>(frames),
                                                  Eigen::Matrix<double, 6, 1>::Zero());
    for (int clip = 0; clip < clips; ++clip) {
        const SmoothPath path = smooth_path(measured(motion, frames, static_cast<unsigned>(clip + 1)));
        for (int f = first; f <= last; ++f) {
            const auto k = static_cast<std::size_t>(f);
            sums[k] += perturbation_between(motion(f * frame_s), path.poses[k]->camera_from_world) / clips;
        }
    }
    double worst = 0;
    for (int f = first; f <= last; ++f) {
        const auto& mean = sums[static_cast<std::size_t>(f)];
        worst = std::max({worst, mean.head<3>().cwiseAbs().maxCoeff() / turn_sigma,
                          mean.tail<3>().cwiseAbs().maxCoeff() / shift_sigma_m});
    }
    return worst;
}

RigidTransform smooth_orbit(double time_s) {
    return test::orbit_pose(0.6 + 0.03 * time_s, 40 + 3 * time_s, 12 * time_s, 2 * time_s);
}

/// Slides at a constant speed until half a second, then stands still.
RigidTransform sudden_stop(double time_s) {
    RigidTransform pose = test::orbit_pose(0.6, 40, 0, 0);
    pose.translation().x() += 0.25 * std::min(time_s, 0.5);
    return pose;
}

/// The speed changes its direction at half a second.
RigidTransform sudden_turn(double time_s) {
    RigidTransform pose = test::orbit_pose(0.6, 40, 0, 0);
    pose.translation().x() += 0.2 * time_s;
    pose.translation().y() += 0.3 * std::max(0.0, time_s - 0.5);
    return pose;
}

/// A hand's tremor of 8 Hz over a slow orbit.
RigidTransform shaken(double time_s) {
    const double phase = 2 * std::numbers::pi * 8 * time_s;
    const Eigen::AngleAxisd shake(0.003 * std::sin(phase), Eigen::Vector3d::UnitX());
    return RigidTransform(shake) * smooth_orbit(time_s);
}

TEST(PathModel, ASmoothPathLosesMostOfItsJitter) {
    const SmoothPath path = smooth_path(measured(smooth_orbit, 48, 3));
    EXPECT_LT(relative_error(path, smooth_orbit, 0, 47), 0.6);
    EXPECT_LT(relative_error(path, smooth_orbit, 8, 39), 0.5);
    for (int f = 0; f < 48; ++f) {
        EXPECT_LT(path.poses[static_cast<std::size_t>(f)]->covariance(0, 0), turn_sigma * turn_sigma);
    }
}

TEST(PathModel, TwelveFramesAreEnough) {
    double sum = 0;
    for (unsigned seed = 1; seed <= 8; ++seed) {
        sum += relative_error(smooth_path(measured(smooth_orbit, 12, seed)), smooth_orbit, 0, 11) / 8;
    }
    EXPECT_LT(sum, 0.85);
}

TEST(PathModel, ASuddenStopStaysSudden) {
    // Frame 12 is the last that moves: ten millimetres a frame until then, a hundred times the noise.
    EXPECT_LT(relative_bias(sudden_stop, 36, 6, 20), 1);
    EXPECT_LT(relative_error(smooth_path(measured(sudden_stop, 36, 2)), sudden_stop, 0, 35), 1.05);
}

TEST(PathModel, AChangeOfDirectionStaysSharp) {
    EXPECT_LT(relative_bias(sudden_turn, 36, 6, 20), 1);
}

TEST(PathModel, AHandsTremorIsMotion) {
    // 3 mrad at 8 Hz, fifteen times the noise, three frames a period.
    EXPECT_LT(relative_bias(shaken, 48, 4, 43), 1);
    EXPECT_LT(relative_error(smooth_path(measured(shaken, 48, 2)), shaken, 0, 47), 1.05);
}

TEST(PathModel, ACutIsNoMotion) {
    const Motion cut = [](double time_s) {
        return time_s < 0.99 ? smooth_orbit(time_s) : test::orbit_pose(1.2, 20, 140 + 5 * time_s, 0);
    };
    const SmoothPath path = smooth_path(measured(cut, 48, 4));
    EXPECT_LT(relative_error(path, cut, 20, 27), 1.3);
    EXPECT_LT(relative_error(path, cut, 0, 47), 1);
}

TEST(PathModel, GapsArePredictedWithGrowingDoubt) {
    auto frames = measured(smooth_orbit, 40, 6);
    for (std::size_t f = 18; f < 22; ++f) frames[f].camera_from_world.reset();
    const SmoothPath path = smooth_path(frames);
    for (std::size_t f = 18; f < 22; ++f) {
        ASSERT_TRUE(path.poses[f]);
        const auto error = perturbation_between(smooth_orbit(double(f) * frame_s), path.poses[f]->camera_from_world);
        const double squares = error.dot(path.poses[f]->covariance.ldlt().solve(error));
        EXPECT_LT(squares, 22.5);  // one in a thousand of χ² with six degrees of freedom
    }
    EXPECT_GT(path.poses[19]->covariance.trace(), path.poses[17]->covariance.trace());
    EXPECT_GT(path.poses[19]->covariance.trace(), path.poses[18]->covariance.trace());
}

}  // namespace
}  // namespace matchlight
