// Rows of the scene file's table for what is done to colours and for repeated blur.
#include "scene/effect_schema.h"
#include "scene/setting_domains.h"

namespace matchlight {

using enum SettingKind;

namespace {

ColorTransformSettings& transform_of(Scene& scene) {
    return *scene.effects.color_transform;
}

std::array<double, 3> row_of(const SettingValue& value) {
    return {value.vector.x(), value.vector.y(), value.vector.z()};
}

}  // namespace

void add_color_transform_settings(std::vector<Setting>& rows) {
    constexpr std::string_view transform = "effects.color_transform", blur = "effects.repeated_blur";
    const std::vector<Setting> added = {
        {transform, "red_from", between(vector, -16, 16), "", "[1, 0, 0]",
         "red is made of so much red, green and blue: a row of a matrix",
         [](Scene& s, const SettingValue& v) { transform_of(s).matrix[0] = row_of(v); }},
        {transform, "green_from", between(vector, -16, 16), "", "[0, 1, 0]", "green, likewise",
         [](Scene& s, const SettingValue& v) { transform_of(s).matrix[1] = row_of(v); }},
        {transform, "blue_from", between(vector, -16, 16), "", "[0, 0, 1]", "blue, likewise",
         [](Scene& s, const SettingValue& v) { transform_of(s).matrix[2] = row_of(v); }},
        {transform, "model", one_of({"hsv", "yiq"}), "", "\"hsv\"",
         "in which hue, saturation and value are: HSV's, or the turn and length of YIQ's chroma and its luma",
         [](Scene& s, const SettingValue& v) { transform_of(s).model = static_cast<ColorModel>(v.choice); }},
        {transform, "hue_deg", between(number, -36000, 36000), "deg", "0", "added to the hue",
         [](Scene& s, const SettingValue& v) { transform_of(s).hue_deg = v.number; }},
        {transform, "saturation", between(number, 0, 16), "", "1", "times the saturation",
         [](Scene& s, const SettingValue& v) { transform_of(s).saturation = v.number; }},
        {transform, "value", between(number, 0, 16), "", "1", "times the value",
         [](Scene& s, const SettingValue& v) { transform_of(s).value = v.number; }},
        {transform, "contrast", between(number, -16, 16), "", "1", "of codes about 1/2; below 0: inverted",
         [](Scene& s, const SettingValue& v) { transform_of(s).contrast = v.number; }},
        {transform, "brightness", between(number, -16, 16), "codes of 1", "0", "added",
         [](Scene& s, const SettingValue& v) { transform_of(s).brightness = v.number; }},
        {transform, "table", of_kind(input_file), "", "",
         "look-up table that codes go through: .cube, .3dl, .csp, .spi1d, .spi3d and what else OpenColorIO reads",
         [](Scene& s, const SettingValue& v) { transform_of(s).table = v.path; }},
        {transform, "grey", one_of({"none", "hsv", "average", "yiq"}), "", "\"none\"",
         "the greatest channel (HSV's value), the mean of the three, or YIQ's luma",
         [](Scene& s, const SettingValue& v) { transform_of(s).grey = static_cast<GreyKind>(v.choice); }},
        {transform, "tint", between(color, 0, 16), "", "[1, 1, 1]", "colour of that grey",
         [](Scene& s, const SettingValue& v) { transform_of(s).tint = color_of(v); }},
        {transform, "fade", between(number, 0, 1), "", "0", "towards fade_color: 1 is that colour",
         [](Scene& s, const SettingValue& v) { transform_of(s).fade = v.number; }},
        {transform, "fade_color", between(color, 0, 16), "codes of 1", "[0, 0, 0]", "what is faded to",
         [](Scene& s, const SettingValue& v) { transform_of(s).fade_color = color_of(v); }},
        {transform, "mask", of_kind(input_file), "", "",
         "picture over the frame, stretched to its size: white is transformed, black is not, grey in part",
         [](Scene& s, const SettingValue& v) { transform_of(s).mask = v.path; }},

        {blur, "passes", between(integer, 1, 32), "", "3", "how often",
         [](Scene& s, const SettingValue& v) { s.effects.repeated_blur->passes = static_cast<int>(v.integer); }},
        {blur, "radius_px", between(integer, 0, 32), "px", "2", "the box is twice that and one pixel wide; 0: none",
         [](Scene& s, const SettingValue& v) { s.effects.repeated_blur->radius_px = static_cast<int>(v.integer); }},
    };
    rows.insert(rows.end(), added.begin(), added.end());
}

}  // namespace matchlight
