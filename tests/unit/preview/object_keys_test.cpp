// What a hand makes of an object that moves by keys.
#include "preview/object_keys.h"

#include <gtest/gtest.h>

#include "core/transforms.h"
#include "scene/object_motion.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;

constexpr const char* scene_text =
    "[camera]\nwidth = 64\nheight = 64\nframes = 40\nfps = 25\n"
    "keys = [{frame = 0, eye = [0, -1, 1], target = [0, 0, 0]}]\n"
    "[[object]]\nshape = \"box\"\n"
    "keys = [{frame = 0, translate = [0, 0, 0.1], rotate_deg = [10, 20, 300]}, # the start\n"
    "        {frame = 20, translate = [0, 0.4, 0.1], rotate_deg = [10, 20, 400], scale = 2}]\n";

SceneText keyed() {
    return {"keyed.toml", scene_text};
}

ObjectSettings object_of(const SceneText& text) {
    Warnings warnings;
    warnings.set_quiet(true);
    return load_scene(text, warnings).objects.at(0);
}

TEST(ObjectKeys, TellHowItStandsAtAndBetweenThem) {
    const ObjectSettings object = object_of(keyed());
    EXPECT_EQ(placing_at(object, 20).rotate_deg, Vector3d(10, 20, 400));
    for (const std::int64_t frame : {5, 10, 17, 30}) {
        const Placing placing = placing_at(object, frame);
        const Eigen::Affine3d truth = object_placement(object, {static_cast<double>(frame), 0});
        const Eigen::Matrix3d linear = rotation_from_degrees(placing.rotate_deg) * placing.scale.asDiagonal();
        // Degrees are rounded to hundredths: 1e-4 radians each.
        EXPECT_TRUE(linear.isApprox(truth.linear(), 5e-4)) << frame;
        EXPECT_TRUE(placing.translate_m.isApprox(truth.translation(), 1e-4)) << frame;
    }
    EXPECT_NEAR(placing_at(object, 10).rotate_deg.z(), 350, 10) << "on its way from 300 to 400, not to 40";
}

TEST(ObjectKeys, AreWrittenWhereTheyAreOrAdded) {
    SceneText text = keyed();
    Placing placing = placing_at(object_of(text), 20);
    placing.translate_m = {0.3, 0.4, 0.1};
    set_placing(text, "object[0]", object_of(text), 20, Grip::move, placing);
    EXPECT_EQ(object_of(text).keys.size(), 2u);
    EXPECT_EQ(object_of(text).keys[1].translate_m, Vector3d(0.3, 0.4, 0.1));
    EXPECT_EQ(object_of(text).keys[1].rotate_deg, Vector3d(10, 20, 400));
    EXPECT_NE(text.text().find("# the start"), std::string::npos);

    placing = placing_at(object_of(text), 10);
    placing.rotate_deg.z() = 15;
    set_placing(text, "object[0]", object_of(text), 10, Grip::turn, placing);
    const ObjectSettings added = object_of(text);
    ASSERT_EQ(added.keys.size(), 3u);
    EXPECT_EQ(added.keys[1].frame, 10);
    EXPECT_EQ(added.keys[1].rotate_deg.z(), 15);
    EXPECT_EQ(added.keys[1].translate_m, placing.translate_m);
    EXPECT_EQ(added.keys[1].scale, placing.scale);
    EXPECT_EQ(added.keys[0], object_of(keyed()).keys[0]);
    set_placing(text, "object[0]", added, 10, Grip::size, {.scale = Vector3d::Constant(3)});
    EXPECT_EQ(object_of(text).keys[1].scale, Vector3d::Constant(3));
}

TEST(ObjectKeys, AreNotGivenToWhatHasNone) {
    SceneText text("still.toml",
                   std::string(scene_text).substr(0, std::string(scene_text).find("keys = [{frame = 0, t")));
    set_placing(text, "object[0]", object_of(text), 7, Grip::lift, {.translate_m = {0, 0, 0.5}});
    EXPECT_TRUE(object_of(text).keys.empty());
    EXPECT_EQ(object_of(text).translate_m, Vector3d(0, 0, 0.5));
    EXPECT_EQ(placing_at(object_of(text), 3).translate_m, Vector3d(0, 0, 0.5));
}

}  // namespace
}  // namespace matchlight
