// Rows of the scene file's table for the motion of objects.
#include "scene/object_motion_schema.h"

#include "scene/setting_domains.h"

namespace matchlight {
namespace {

using enum SettingKind;

/// Keys may lie before the clip and after it, so that an object is on its way when it begins.
constexpr double farthest_frame = 1e9;

}  // namespace

void begin_object_key(Scene& scene) {
    ObjectSettings& object = scene.objects.back();
    object.keys.push_back({.translate_m = object.translate_m, .rotate_deg = object.rotate_deg, .scale = object.scale});
}

const std::vector<Setting>& object_motion_settings() {
    constexpr std::string_view keys = "object.keys", spin = "object.spin", object = "object";
    static const std::vector<Setting> settings = {
        {keys, "frame", between(integer, -farthest_frame, farthest_frame), "", must_be_given,
         "counted from 0, ascending; may lie outside the clip",
         [](Scene& s, const SettingValue& v) { s.objects.back().keys.back().frame = v.integer; }},
        {keys, "translate", between(vector, -1e6, 1e6), "m", "", "where it is",
         [](Scene& s, const SettingValue& v) { s.objects.back().keys.back().translate_m = v.vector; }},
        {keys, "rotate_deg", between(rotation, -36000, 36000), "deg", "",
         "how it is turned; from key to key about one axis, with the full turns that the difference holds",
         [](Scene& s, const SettingValue& v) { s.objects.back().keys.back().rotate_deg = v.vector; }},
        {keys, "scale", above(scale, 0, 1e6), "", "", "one number, or one an axis",
         [](Scene& s, const SettingValue& v) { s.objects.back().keys.back().scale = v.vector; }},

        {spin, "axis", between(vector, -1e6, 1e6), "", "[0, 0, 1]", "in the axes that translate is in",
         [](Scene& s, const SettingValue& v) { s.objects.back().spin->axis = v.vector; }},
        {spin, "turns_per_second", between(number, -1e6, 1e6), "1/s", must_be_given,
         "counter-clockwise seen from the axis' tip, from the clip's start",
         [](Scene& s, const SettingValue& v) { s.objects.back().spin->turns_per_second = v.number; }},

        {object, "animation", of_kind(text), "", "",
         "of the model: its name, or its number from 0; \"none\": at rest; the first unless given",
         [](Scene& s, const SettingValue& v) { s.objects.back().animation.name = v.text; }},
        {object, "animation_speed", between(number, -1e3, 1e3), "", "1", "below 0: backwards",
         [](Scene& s, const SettingValue& v) { s.objects.back().animation.speed = v.number; }},
        {object, "animation_start", between(number, -1e6, 1e6), "s", "0", "where in it the clip begins",
         [](Scene& s, const SettingValue& v) { s.objects.back().animation.start_s = v.number; }},
        {object, "animation_loop", of_kind(boolean), "", "true", "from its end it begins anew; false: it stays there",
         [](Scene& s, const SettingValue& v) { s.objects.back().animation.loop = v.boolean; }},
    };
    return settings;
}

}  // namespace matchlight
