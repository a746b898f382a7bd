// Rows of the scene file's table for the shutter.
#include "scene/effect_schema.h"
#include "scene/setting_domains.h"

namespace matchlight {

using enum SettingKind;

void add_motion_blur_settings(std::vector<Setting>& rows) {
    constexpr std::string_view section = "effects.motion_blur";
    const std::vector<Setting> added = {
        {section, "level", one_of({"gather", "sub_frames", "reference"}), "", "\"gather\"",
         "how it is computed; gather: one picture, blurred along the way of each pixel; sub_frames: the scene drawn at "
         "several times; reference: at 128",
         [](Scene& s, const SettingValue& v) {
             s.effects.motion_blur->level = static_cast<MotionBlurLevel>(v.choice);
         }},
        {section, "shutter", between(number, 0, 1), "", "",
         "share of a frame's time that the shutter is open; the solve's, and 0.5 without footage, unless given",
         [](Scene& s, const SettingValue& v) { s.effects.motion_blur->shutter = v.number; }},
        {section, "sub_frames", between(integer, 1, 65536), "", "8", "times at which the scene is drawn, of that level",
         [](Scene& s, const SettingValue& v) { s.effects.motion_blur->sub_frames = static_cast<int>(v.integer); }},
    };
    rows.insert(rows.end(), added.begin(), added.end());
}

}  // namespace matchlight
