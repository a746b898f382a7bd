// Rows of the scene file's table for the thin lens.
#include "scene/depth_of_field_levels.h"
#include "scene/effect_schema.h"
#include "scene/setting_domains.h"

namespace matchlight {

using enum SettingKind;

void add_depth_of_field_settings(std::vector<Setting>& rows) {
    constexpr std::string_view section = "effects.depth_of_field", bokeh = "effects.depth_of_field.bokeh";
    const std::vector<Setting> added = {
        {section, "level", one_of({depth_of_field_levels.begin(), depth_of_field_levels.end()}), "", "\"gather\"",
         "how it is computed; lens_samples: the scene drawn from many points of the lens",
         [](Scene& s, const SettingValue& v) {
             s.effects.depth_of_field->level = static_cast<DepthOfFieldLevel>(v.choice);
         }},
        {section, "focus_distance_m", between(number, 1e-3, 1e9), "m", "", "instead of the solve's, or the camera's",
         [](Scene& s, const SettingValue& v) { s.effects.depth_of_field->focus_distance_m = v.number; }},
        {section, "coc_scale_px_m", between(number, 0, 1e9), "px·m", "",
         "circle of confusion in pixels = scale · |1/focus − 1/z|; instead of the solve's, or the camera's",
         [](Scene& s, const SettingValue& v) { s.effects.depth_of_field->coc_scale_px_m = v.number; }},
        {section, "focus_on", one_of({"distance", "middle", "point", "object"}), "", "\"distance\"",
         "what stays sharp, frame by frame: what is in the picture's middle, `point` or `object`",
         [](Scene& s, const SettingValue& v) {
             s.effects.depth_of_field->focus_on = static_cast<FocusTarget>(v.choice);
         }},
        {section, "point", between(vector, -1e6, 1e6), "m", "", "of the world, for `focus_on`",
         [](Scene& s, const SettingValue& v) {
             s.effects.depth_of_field->focus_point_m = {v.vector.x(), v.vector.y(), v.vector.z()};
         }},
        {section, "object", of_kind(text), "", "", "an object's name, for `focus_on`",
         [](Scene& s, const SettingValue& v) { s.effects.depth_of_field->focus_object = v.text; }},
        {section, "lens_samples", between(integer, 1, 65536), "", "64", "points of the lens, of that level",
         [](Scene& s, const SettingValue& v) { s.effects.depth_of_field->lens_samples = static_cast<int>(v.integer); }},
        {section, "reflections", one_of({"virtual_image", "surface"}), "", "\"virtual_image\"",
         "where what mirrors show is in focus; lens_samples: always at its virtual image",
         [](Scene& s, const SettingValue& v) {
             s.effects.depth_of_field->reflections = static_cast<ReflectionFocus>(v.choice);
         }},
        {section, "bokeh", of_kind(SettingKind::section), "", "", "the shape of out-of-focus discs", nullptr},
        {bokeh, "blades", between(integer, 0, 32), "", "0", "0: round",
         [](Scene& s, const SettingValue& v) { s.effects.depth_of_field->bokeh.blades = static_cast<int>(v.integer); }},
        {bokeh, "rotation_deg", between(number, -36000, 36000), "deg", "0", "counter-clockwise",
         [](Scene& s, const SettingValue& v) { s.effects.depth_of_field->bokeh.rotation_deg = v.number; }},
        {bokeh, "roundness", between(number, 0, 1), "", "0", "0: straight blades; 1: a circle",
         [](Scene& s, const SettingValue& v) { s.effects.depth_of_field->bokeh.roundness = v.number; }},
    };
    rows.insert(rows.end(), added.begin(), added.end());
}

}  // namespace matchlight
