// Objects on their way: through keys, by full turns, spinning; and the settings that say so.
#include "scene/object_motion.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/transforms.h"
#include "temporary_folder.h"

namespace matchlight {
namespace {

using testing::HasSubstr;

Eigen::Matrix3d rotation_of(const ObjectSettings& object, double frame) {
    return object_placement(object, {.frame = frame}).linear();
}

Eigen::Matrix3d turned(double degrees, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()).toRotationMatrix();
}

ObjectSettings turning(const std::vector<std::pair<std::int64_t, Eigen::Vector3d>>& rotate_deg) {
    ObjectSettings object;
    for (const auto& [frame, degrees] : rotate_deg) object.keys.push_back({.frame = frame, .rotate_deg = degrees});
    return object;
}

TEST(ObjectMotion, WithoutKeysAnObjectStandsWhereItWasPut) {
    ObjectSettings object;
    object.translate_m = {1, 2, 3};
    object.rotate_deg = {10, 20, 30};
    object.scale = {1, 2, 4};
    EXPECT_FALSE(moves(object));
    const Eigen::Affine3d expected =
        Eigen::Translation3d(1, 2, 3) * rotation_from_degrees({10, 20, 30}) * Eigen::Scaling(1.0, 2.0, 4.0);
    EXPECT_EQ(object_placement(object, {.frame = 5, .time_s = 0.2}).matrix(), expected.matrix());
}

TEST(ObjectMotion, GoesThroughItsKeysAndRestsBeyond) {
    ObjectSettings object;
    object.keys = {{.frame = -2, .translate_m = {0, 0, 1}, .rotate_deg = {10, 0, 0}, .scale = {1, 1, 1}},
                   {.frame = 3, .translate_m = {1, 0, 1}, .rotate_deg = {50, 70, 0}, .scale = {2, 1, 0.01}},
                   {.frame = 4, .translate_m = {1, 5, 1}, .rotate_deg = {-170, 0, 400}, .scale = {2, 9, 1}}};
    EXPECT_TRUE(moves(object));
    const auto at_key = [](const ObjectKey& key) -> Eigen::Affine3d {
        return Eigen::Translation3d(key.translate_m) * rotation_from_degrees(key.rotate_deg) *
               Eigen::Scaling(key.scale);
    };
    for (const ObjectKey& key : object.keys) {
        const Eigen::Affine3d placed = object_placement(object, {.frame = static_cast<double>(key.frame)});
        EXPECT_TRUE(placed.isApprox(at_key(key), 1e-12)) << key.frame;
    }
    EXPECT_TRUE(object_placement(object, {.frame = -100}).isApprox(at_key(object.keys.front()), 1e-12));
    EXPECT_TRUE(object_placement(object, {.frame = 100}).isApprox(at_key(object.keys.back()), 1e-12));
    for (double frame = -2; frame < 4; frame += 0.1) {
        EXPECT_GT(object_placement(object, {.frame = frame}).linear().determinant(), 0) << "no scale turns negative";
    }
}

TEST(ObjectMotion, FullTurnsAreTurnedAtAnEvenPace) {
    const ObjectSettings once = turning({{0, {0, 0, 0}}, {8, {0, 0, 360}}});
    const ObjectSettings thrice = turning({{0, {0, 0, 30}}, {5, {0, 0, 390}}, {15, {0, 0, 1110}}});
    const ObjectSettings back = turning({{0, {0, 0, 0}}, {10, {0, 0, -350}}});
    for (double frame = 0; frame <= 8; frame += 0.5) {
        EXPECT_TRUE(rotation_of(once, frame).isApprox(turned(45 * frame, {0, 0, 1}), 1e-9)) << frame;
        EXPECT_TRUE(rotation_of(thrice, frame).isApprox(turned(30 + 72 * frame, {0, 0, 1}), 1e-9)) << frame;
        EXPECT_TRUE(rotation_of(back, frame).isApprox(turned(-35 * frame, {0, 0, 1}), 1e-9)) << frame;
    }
}

TEST(ObjectMotion, EachOfTheThreeAnglesTurnsAboutItsOwnAxis) {
    // R = Rz·Ry·Rx: with y and z held, x turns about where they have put it.
    const Eigen::Matrix3d held = rotation_from_degrees({0, 25, 40});
    const ObjectSettings object = turning({{0, {0, 25, 40}}, {10, {720, 25, 40}}});
    for (double frame = 0; frame <= 10; frame += 0.5) {
        EXPECT_TRUE(rotation_of(object, frame).isApprox(held * turned(72 * frame, {1, 0, 0}), 1e-9)) << frame;
    }
}

TEST(ObjectMotion, TurnsWithoutJerks) {
    const ObjectSettings object = turning({{0, {0, 0, 0}}, {4, {80, 10, 60}}, {7, {80, 200, 500}}, {12, {0, 0, 0}}});
    constexpr double step = 1e-5;
    const auto spin_between = [&](double from, double to) -> Eigen::Vector3d {
        const Eigen::AngleAxisd turn(rotation_of(object, to) * rotation_of(object, from).transpose());
        return turn.angle() * turn.axis() / (to - from);
    };
    for (const double frame : {4.0, 7.0}) {
        EXPECT_LT((spin_between(frame - step, frame) - spin_between(frame, frame + step)).norm(), 1e-3) << frame;
    }
    for (double frame = 0; frame < 12; frame += 0.01) {
        EXPECT_LT(spin_between(frame, frame + 0.01).norm(), 4) << "no turn is more than asked for, at " << frame;
    }
}

TEST(ObjectMotion, SpinsByTime) {
    ObjectSettings object;
    object.rotate_deg = {90, 0, 0};
    object.translate_m = {1, 0, 0};
    object.spin = SpinSettings{.axis = {0, 0, 20}, .turns_per_second = 0.25};
    EXPECT_TRUE(moves(object));
    const Eigen::Affine3d placed = object_placement(object, {.frame = 0, .time_s = 1});
    EXPECT_TRUE(placed.linear().isApprox(turned(90, {0, 0, 1}) * turned(90, {1, 0, 0}), 1e-12));
    EXPECT_EQ(placed.translation(), Eigen::Vector3d(1, 0, 0)) << "it turns in its place";
    EXPECT_TRUE(object_placement(object, {.frame = 0, .time_s = 4e6 + 1}).isApprox(placed, 1e-8));
    object.spin->turns_per_second = 0;
    EXPECT_FALSE(moves(object));
}

class ObjectMotionSettings : public TemporaryFolder {
protected:
    Scene load(const std::string& object) {
        Warnings warnings;
        warnings.set_quiet(true);
        return load_scene(write("scene.toml",
                                "[camera]\nwidth = 8\nheight = 6\norbit = {radius = 1}\n"
                                "[[object]]\nshape = \"box\"\n" +
                                    object),
                          warnings);
    }
    std::string error_of(const std::string& object) {
        try {
            load(object);
        } catch (const InputError& error) {
            return error.what();
        }
        return "no error";
    }
};

TEST_F(ObjectMotionSettings, WhatAKeyLeavesOutIsAsTheObjectHasIt) {
    const Scene scene = load(
        "keys = [{frame = -1}, {frame = 5, translate = [0, 0, 1], rotate_deg = 90, scale = 3}]\n"
        "translate = [1, 2, 3]\nscale = 2\nspin = {turns_per_second = 0.5}\n");
    const ObjectSettings& object = scene.objects.at(0);
    ASSERT_EQ(object.keys.size(), 2u);
    EXPECT_EQ(object.keys[0].frame, -1);
    EXPECT_EQ(object.keys[0].translate_m, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(object.keys[0].scale, Eigen::Vector3d(2, 2, 2));
    EXPECT_EQ(object.keys[1].translate_m, Eigen::Vector3d(0, 0, 1));
    EXPECT_EQ(object.keys[1].rotate_deg, Eigen::Vector3d(0, 0, 90));
    EXPECT_EQ(object.keys[1].scale, Eigen::Vector3d(3, 3, 3));
    EXPECT_EQ(object.spin->axis, Eigen::Vector3d::UnitZ());
    EXPECT_EQ(object.spin->turns_per_second, 0.5);
}

TEST_F(ObjectMotionSettings, MistakesNameTheLineAndTheCure) {
    const std::vector<std::pair<std::string, std::string>> rows = {
        {"keys = [{frame = 3},\n{frame = 3}]\n", "scene.toml:8: keys of [[object]] 1: frame 3 does not come after 3"},
        {"keys = [{translate = [0, 0, 0]}]\n", "'frame' is missing in [object.keys]"},
        {"keys = []\n", "'keys' in [object] is a list of at least one entry"},
        {"keys = [{frame = 0, scale = 0}]\n", "'scale' in [object.keys] is 0, outside its range"},
        {"keys = [{frame = 0, rotation_deg = 0}]\n", "unknown key 'rotation_deg' in [object.keys]"},
        {"spin = {axis = [0, 0, 0], turns_per_second = 1}\n", "scene.toml:7: 'axis' in [object.spin] has no direction"},
        {"spin = {axis = [0, 0, 1]}\n", "'turns_per_second' is missing in [object.spin]"},
        {"spin = {turns_per_second = nan}\n", "'turns_per_second' in [object.spin] is not finite"},
    };
    for (const auto& [text, expected] : rows) EXPECT_THAT(error_of(text), HasSubstr(expected)) << text;
}

}  // namespace
}  // namespace matchlight
