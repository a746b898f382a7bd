// The pose at mid-exposure from streaks, against a camera whose motion is known.
#include "tracking/rig_image_fit.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "moving_rig.h"

namespace matchlight {
namespace {

using test::corner_distance_px;
using test::moving_view;
using test::ordinary_camera;

constexpr double never_clipped = 2;

/// A turn that shifts the picture of a camera at 0.55 m by about so many pixels, with some of everything else.
PoseStep motion_of(double right_px, double down_px) {
    const double m_per_px = 0.55 / ordinary_camera().fx;
    PoseStep motion;
    motion << 0.01, -0.008, 0.02, right_px * m_per_px, down_px * m_per_px, 0.003;
    return motion;
}

const RigidTransform true_pose = test::orbit_pose(0.55, 30, 20, 8);

MovingCamera start_off_by(double error_px, const PoseStep& motion) {
    return {perturbed(true_pose, motion_of(0.8 * error_px, -0.6 * error_px)), motion, 1};
}

TEST(RigImageFit, FindsMidExposureInAStreakOfThirtyPixels) {
    // Cells of the tags are 8 to 11 px wide: the streak covers three of them, and no tag is detected.
    const PoseStep motion = motion_of(28, 10);
    ImageF light = reference_light(moving_view(true_pose, motion, PoseStep::Zero()));
    test::add_noise(light, 1, 3);
    const LensGrid lens(ordinary_camera());
    EXPECT_TRUE(TagDetector("tag36h11", {}).detect(detection_image(light)).empty());
    const std::vector<PlacedSheet> sheets = test::placed(test::three_sheets());
    // The start is 15 px off, and its motion two thirds of the true one.
    const auto fit = fit_rig_image({light, 0, 0, lens, never_clipped}, sheets, start_off_by(15, 0.67 * motion), {25});
    ASSERT_TRUE(fit);
    EXPECT_LT(corner_distance_px(fit->camera.camera_from_world, true_pose, ordinary_camera()), 0.1);
    EXPECT_GT(fit->correlation, 0.97);
    ASSERT_EQ(fit->sheets.size(), 3u);
    const double true_streak_px = SheetImage(sheets[0], {true_pose, motion, 1}, ordinary_camera()).streak_px();
    EXPECT_NEAR(fit->sheets[0].streak_px, true_streak_px, 0.03 * true_streak_px);
}

TEST(RigImageFit, AStillCameraIsFoundWithoutMotion) {
    const ImageF light = reference_light(moving_view(true_pose, PoseStep::Zero(), PoseStep::Zero()));
    const LensGrid lens(ordinary_camera());
    const std::vector<PlacedSheet> sheets = test::placed(test::three_sheets());
    const auto fit = fit_rig_image({light, 0, 0, lens, never_clipped}, sheets, start_off_by(5, motion_of(8, 3)), {10});
    ASSERT_TRUE(fit);
    EXPECT_LT(corner_distance_px(fit->camera.camera_from_world, true_pose, ordinary_camera()), 0.05);
    EXPECT_LT(fit->sheets[0].streak_px, 1.5);
}

TEST(RigImageFit, KnowsHowItsPoseFollowsAnAcceleration) {
    // A streak of 20 px that bends by 12 px: at mid-exposure the camera is half a pixel from the middle of its way.
    const PoseStep motion = motion_of(20, 6), bend = motion_of(12, 2) - motion_of(0, 0);
    const ImageF light = reference_light(moving_view(true_pose, motion, bend));
    const LensGrid lens(ordinary_camera());
    const std::vector<PlacedSheet> sheets = test::placed(test::three_sheets());
    const auto fit = fit_rig_image({light, 0, 0, lens, never_clipped}, sheets, start_off_by(4, motion), {10});
    ASSERT_TRUE(fit);
    const double uncorrected_px = corner_distance_px(fit->camera.camera_from_world, true_pose, ordinary_camera());
    EXPECT_GT(uncorrected_px, 0.4);
    const RigidTransform corrected = perturbed(fit->camera.camera_from_world, fit->pose_by_bend * bend);
    EXPECT_LT(corner_distance_px(corrected, true_pose, ordinary_camera()), 0.1);
}

TEST(RigImageFit, KnowsWhereACameraThatTurnsBackWas) {
    // It comes and goes by the same 3 px within the exposure: the middle of its way is a pixel from where it turns.
    const PoseStep bend = motion_of(24, 4);
    const ImageF light = reference_light(moving_view(true_pose, PoseStep::Zero(), bend));
    const LensGrid lens(ordinary_camera());
    const std::vector<PlacedSheet> sheets = test::placed(test::three_sheets());
    const auto fit = fit_rig_image({light, 0, 0, lens, never_clipped}, sheets, start_off_by(3, PoseStep::Zero()), {8});
    ASSERT_TRUE(fit);
    EXPECT_GT(corner_distance_px(fit->camera.camera_from_world, true_pose, ordinary_camera()), 0.7);
    const RigidTransform corrected = perturbed(fit->camera.camera_from_world, fit->pose_by_bend * bend);
    EXPECT_LT(corner_distance_px(corrected, true_pose, ordinary_camera()), 0.2);
}

TEST(RigImageFit, ErrorsAreWithinTheirCovariance) {
    const PoseStep motion = motion_of(18, -12);
    const ImageF clean = reference_light(moving_view(true_pose, motion, PoseStep::Zero()));
    const LensGrid lens(ordinary_camera());
    const std::vector<PlacedSheet> sheets = test::placed(test::three_sheets());
    double squares = 0;
    constexpr unsigned trials = 6;
    for (unsigned seed = 1; seed <= trials; ++seed) {
        ImageF light = clean;
        test::add_noise(light, 2, seed);
        const auto fit = fit_rig_image({light, 0, 0, lens, never_clipped}, sheets, start_off_by(3, motion), {8});
        ASSERT_TRUE(fit);
        const PoseStep error = perturbation_between(true_pose, fit->camera.camera_from_world);
        squares += error.dot(fit->covariance.ldlt().solve(error)) / 6;
    }
    // As for single tags: allowance for errors that neighbouring pixels share makes it 1/4 where they are independent.
    EXPECT_GT(squares / trials, 0.05);
    EXPECT_LT(squares / trials, 1.0);
}

TEST(RigImageFit, OtherTagsOrNoneAreNotTheRig) {
    const PoseStep motion = motion_of(20, 5);
    const LensGrid lens(ordinary_camera());
    const std::vector<PlacedSheet> sheets = test::placed(test::three_sheets());
    TagView others = moving_view(true_pose, motion, PoseStep::Zero());
    const TagFamily family("tag36h11");
    for (TagSheet& sheet : others.tags) sheet.pattern = family.pattern(sheet.id + 40);
    ImageF light = reference_light(others);
    test::add_noise(light, 1, 1);
    EXPECT_FALSE(fit_rig_image({light, 0, 0, lens, never_clipped}, sheets, start_off_by(5, motion), {15}));
    TagView none = moving_view(true_pose, motion, PoseStep::Zero());
    none.tags.clear();
    light = reference_light(none);
    test::add_noise(light, 2, 1);
    EXPECT_FALSE(fit_rig_image({light, 0, 0, lens, never_clipped}, sheets, start_off_by(5, motion), {15}));
}

}  // namespace
}  // namespace matchlight
