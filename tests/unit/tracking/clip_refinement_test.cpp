// The clip adjusted as a whole: consistent covariances, a common plane, the lens, the shutter.
#include "tracking/clip_refinement.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "core/error.h"
#include "synthetic_clip.h"
#include "tracking/lens_start.h"

namespace matchlight {
namespace {

using test::SyntheticClip;

SyntheticClip ordinary_clip() {
    SyntheticClip clip;
    clip.tags = test::flat_tags();
    clip.camera_from_world = test::wandering;
    return clip;
}

/// Squared errors of all poses in units of their covariance: 6 expected.
double mean_squares(const SyntheticClip& clip, const GeometrySolution& solved) {
    double sum = 0;
    int count = 0;
    for (const PathFrame& frame : solved.path.frames) {
        if (!frame.pose) continue;
        const Eigen::Matrix<double, 6, 1> error =
            perturbation_between(frame.pose->camera_from_world, clip.camera_from_world(frame.time_s));
        sum += error.dot(frame.pose->covariance.ldlt().solve(error));
        ++count;
    }
    return sum / count;
}

double mean_error_px(const SyntheticClip& clip, const GeometrySolution& solved) {
    double sum = 0;
    int count = 0;
    for (const PathFrame& frame : solved.path.frames) {
        if (!frame.pose) continue;
        sum += test::registration_px(clip.camera, frame.pose->camera_from_world, clip.camera_from_world(frame.time_s));
        ++count;
    }
    return sum / count;
}

const LensParameter* parameter(const GeometrySolution& solved, const std::string& name) {
    const auto found = std::ranges::find(solved.lens_parameters, name, &LensParameter::name);
    return found == solved.lens_parameters.end() ? nullptr : &*found;
}

TEST(ClipRefinement, CovariancesOfPosesAreConsistent) {
    // Corners that stay off by 0.05 px and jump by 0.03: only together do they explain the errors, which are the same
    // in all frames of a clip. A dozen clips give twelve times six independent errors: 6 ± 1, three standard deviations
    // wide.
    double given_sum = 0, solved_sum = 0;
    constexpr unsigned clips = 12;
    for (unsigned seed = 1; seed <= clips; ++seed) {
        SyntheticClip clip = ordinary_clip();
        clip.frames = 24;
        clip.bias_px = 0.05;
        clip.seed = seed;
        const ClipObservations seen = clip.observe();
        given_sum += mean_squares(clip, clip.solve(seen, {0, 1, 2, 3}, test::calibrated_scene(LensRefinement::off)));
        solved_sum += mean_squares(clip, clip.solve(seen, {0}, test::calibrated_scene(LensRefinement::off)));
    }
    EXPECT_GT(given_sum / clips, 3);
    EXPECT_LT(given_sum / clips, 9);
    EXPECT_GT(solved_sum / clips, 3);
    EXPECT_LT(solved_sum / clips, 9);
}

/// By how much the world's horizon is off (rad), over all poses.
double mean_tilt_error(const SyntheticClip& clip, const GeometrySolution& solved) {
    double sum = 0;
    for (const PathFrame& frame : solved.path.frames) {
        sum +=
            perturbation_between(clip.camera_from_world(frame.time_s), frame.pose->camera_from_world).head<2>().norm();
    }
    return sum / static_cast<double>(solved.path.frames.size());
}

TEST(ClipRefinement, ACommonPlaneSteadiesTheOrigin) {
    // One tag's tilt, seen from above, is a poor horizon; the sheets around it are a good one when they lie on one
    // plane.
    double flat = 0, uneven = 0;
    constexpr unsigned clips = 6;
    for (unsigned seed = 1; seed <= clips; ++seed) {
        SyntheticClip clip = ordinary_clip();
        clip.camera_from_world = [](double time_s) {
            return test::orbit_pose(0.62, 14 + 4 * time_s, 10 * time_s, 5 * time_s);
        };
        clip.frames = 10;
        clip.bias_px = 0.05;
        clip.seed = seed;
        flat += mean_tilt_error(clip, clip.solve(clip.observe(), {}, test::calibrated_scene(LensRefinement::off)));
        for (std::size_t i = 1; i < clip.tags.size(); ++i) {
            clip.tags[i].world_from_tag.translation().z() = i == 2 ? -0.02 : 0.015 * double(i);
        }
        uneven += mean_tilt_error(clip, clip.solve(clip.observe(), {}, test::calibrated_scene(LensRefinement::off)));
    }
    EXPECT_LT(flat, 0.6 * uneven);
    EXPECT_LT(flat / clips, 0.002);
}

TEST(ClipRefinement, ASheetOnASlopeIsNotFlattened) {
    SyntheticClip clip = ordinary_clip();
    clip.tags[3].world_from_tag.linear() = rotation_from_degrees({1.5, 0, -30});  // a folder under its edge
    clip.tags[3].world_from_tag.translation().z() = 0.002;
    const GeometrySolution solved = clip.solve(clip.observe(), {0}, test::calibrated_scene());
    const RigidTransform error = clip.tags[3].world_from_tag.inverse() * solved.rig.world_from_tag.at(3);
    EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), 0.003);
    EXPECT_LT(error.translation().norm(), 2e-4);
}

TEST(ClipRefinement, ALensThatIsRightStays) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        SyntheticClip clip = ordinary_clip();
        clip.seed = seed;
        clip.bias_px = 0.03;
        const GeometrySolution solved = clip.solve(clip.observe(), {0, 1, 2, 3}, test::calibrated_scene());
        // Where chance asks for a correction it is a small one.
        EXPECT_NEAR(solved.camera.cx, clip.camera.cx, 0.3);
        EXPECT_NEAR(solved.camera.cy, clip.camera.cy, 0.3);
        EXPECT_NEAR(solved.camera.fx / clip.camera.fx, 1, 1e-3);
    }
}

TEST(ClipRefinement, AShiftedPrincipalPointIsFound) {
    SyntheticClip clip = ordinary_clip();
    clip.frames = 120;
    Camera calibrated = clip.camera;
    calibrated.cx += 5;
    calibrated.cy -= 4;
    calibrated.sigmas = CameraSigmas{1.5, 1.5, 4, 4, {0.01, 0.05, 1e-3, 1e-3, 0}};
    ClipObservations seen = clip.observe();
    express_with(calibrated, clip.camera, seen.frames);
    const GeometrySolution solved = clip.solve(seen, {0, 1, 2, 3}, test::calibrated_scene(), calibrated);
    const LensParameter* cx = parameter(solved, "cx");
    const LensParameter* cy = parameter(solved, "cy");
    ASSERT_TRUE(cx && cy);
    EXPECT_TRUE(cx->refined && cy->refined);
    EXPECT_LT(std::abs(solved.camera.cx - clip.camera.cx), 4 * cx->sigma);
    EXPECT_LT(std::abs(solved.camera.cy - clip.camera.cy), 4 * cy->sigma);
    EXPECT_LT(cx->sigma, 0.3);

    const GeometrySolution held =
        clip.solve(seen, {0, 1, 2, 3}, test::calibrated_scene(LensRefinement::off), calibrated);
    EXPECT_EQ(held.camera.cx, calibrated.cx);
    EXPECT_LT(mean_error_px(clip, solved), 0.3 * mean_error_px(clip, held));
}

TEST(ClipRefinement, AnUnknownLensIsFoundWithThePath) {
    SyntheticClip clip = ordinary_clip();
    clip.frames = 120;
    clip.bias_px = 0.03;
    clip.camera.distortion = {-0.09, 0.03, 0, 0, 0};
    Scene scene;
    scene.footage.video = "clip.mp4";
    const Camera guess = guessed_camera(clip.camera.width, clip.camera.height);
    ClipObservations seen = clip.observe();
    express_with(guess, clip.camera, seen.frames);
    const GeometrySolution solved = clip.solve(seen, {}, scene, guess);
    const LensParameter* fx = parameter(solved, "fx");
    ASSERT_TRUE(fx);
    EXPECT_NEAR(solved.camera.fx / clip.camera.fx, 1, 0.005);
    EXPECT_LT(std::abs(solved.camera.fx - clip.camera.fx), 4 * fx->sigma);
    EXPECT_NEAR(solved.camera.distortion[0], -0.09, 0.02);
    EXPECT_EQ(solved.path.missing, 0);
}

TEST(ClipRefinement, FocalLengthAndDistanceAreOneFromTheFront) {
    SyntheticClip clip = ordinary_clip();
    clip.frames = 30;
    clip.camera_from_world = [](double time_s) { return test::orbit_pose(0.7, 0.2, 4 * time_s, 3 * time_s); };
    Scene scene;
    scene.footage.video = "clip.mp4";
    const Camera guess = guessed_camera(clip.camera.width, clip.camera.height);
    ClipObservations seen = clip.observe();
    express_with(guess, clip.camera, seen.frames);
    EXPECT_THROW(clip.solve(seen, {}, scene, guess), InputError);
}

TEST(ClipRefinement, ReadOutTimeComesFromMotion) {
    SyntheticClip clip = ordinary_clip();
    clip.readout_s = 0.02;
    clip.camera_from_world = [](double time_s) {
        // Half a turn of the wrist a second: some 3 px between the first row and the last of a tag.
        return test::orbit_pose(0.6, 40 + 15 * std::sin(5 * time_s), 20 * std::sin(4 * time_s),
                                10 * std::sin(6 * time_s));
    };
    Scene scene = test::calibrated_scene(LensRefinement::off);
    scene.footage.solve_readout = true;
    const ClipObservations seen = clip.observe();
    const GeometrySolution solved = clip.solve(seen, {0, 1, 2, 3}, scene);
    ASSERT_TRUE(solved.readout_s);
    EXPECT_NEAR(*solved.readout_s, 0.02, 0.001);
    const GeometrySolution global = clip.solve(seen, {0, 1, 2, 3}, test::calibrated_scene(LensRefinement::off));
    EXPECT_FALSE(global.readout_s);
    EXPECT_LT(mean_error_px(clip, solved), 0.3 * mean_error_px(clip, global));
}

TEST(ClipRefinement, AStillCameraDoesNotTellItsReadOut) {
    SyntheticClip clip = ordinary_clip();
    clip.frames = 24;
    clip.camera_from_world = [](double) { return test::orbit_pose(0.6, 40, 10, 0); };
    Scene scene = test::calibrated_scene();
    scene.footage.solve_readout = true;
    const GeometrySolution solved = clip.solve(clip.observe(), {0, 1, 2, 3}, scene);
    EXPECT_FALSE(solved.readout_s);
    ASSERT_TRUE(solved.readout_sigma_s);
    EXPECT_GT(*solved.readout_sigma_s, 0.004);
}

TEST(ClipRefinement, TagsArePredictedByTheOthers) {
    SyntheticClip clip = ordinary_clip();
    clip.frames = 20;
    const GeometrySolution solved = clip.solve(clip.observe(), {0, 1, 2, 3}, test::calibrated_scene());
    ASSERT_EQ(solved.leave_one_out_px.size(), 20u * 4u);
    const double mean =
        std::accumulate(solved.leave_one_out_px.begin(), solved.leave_one_out_px.end(), 0.0) / (20.0 * 4.0);
    EXPECT_GT(mean, 0.03);  // the tag's own noise,
    EXPECT_LT(mean, 0.15);  // and that of three other tags' pose
}

}  // namespace
}  // namespace matchlight
