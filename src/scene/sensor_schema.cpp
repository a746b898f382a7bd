// Rows of the scene file's table for what sensor, lens and codec do to the picture: grain, vignette, colour, softness.
#include "scene/effect_schema.h"
#include "scene/setting_domains.h"

namespace matchlight {

using enum SettingKind;

void add_sensor_settings(std::vector<Setting>& rows) {
    constexpr std::string_view grain = "effects.grain", vignette = "effects.vignette";
    constexpr std::string_view aberration = "effects.chromatic_aberration", softness = "effects.softness";
    const std::vector<Setting> added = {
        {grain, "read", between(number, 0, 1), "plate-linear", "",
         "variance = read² + shot · light; the solve's unless given",
         [](Scene& s, const SettingValue& v) { s.effects.grain->read = v.number; }},
        {grain, "shot", between(number, 0, 1), "plate-linear", "", "likewise",
         [](Scene& s, const SettingValue& v) { s.effects.grain->shot = v.number; }},
        {grain, "correlation_px", between(number, 0, 4), "px", "",
         "standard deviation of the Gaussian that smooths the noise, 0: none; by the solve unless given",
         [](Scene& s, const SettingValue& v) { s.effects.grain->correlation_px = v.number; }},
        {grain, "strength", between(number, 0, 100), "", "1", "times the noise that is added",
         [](Scene& s, const SettingValue& v) { s.effects.grain->strength = v.number; }},
        {grain, "seed", between(integer, 0, 1e9), "", "1", "other noise",
         [](Scene& s, const SettingValue& v) { s.effects.grain->seed = static_cast<int>(v.integer); }},

        {aberration, "red_px", between(number, -100, 100), "px", "",
         "of red against green in the frame's corners, away from its middle; under a quarter pixel there is none",
         [](Scene& s, const SettingValue& v) { s.effects.chromatic_aberration->red_px = v.number; }},
        {aberration, "blue_px", between(number, -100, 100), "px", "", "of blue, likewise",
         [](Scene& s, const SettingValue& v) { s.effects.chromatic_aberration->blue_px = v.number; }},

        {softness, "sigma_px", between(number, 0, 16), "px", "",
         "standard deviation of a Gaussian; the solve's unless given; under 0.2 there is none",
         [](Scene& s, const SettingValue& v) { s.effects.softness->sigma_px = v.number; }},

        {vignette, "v1", between(number, -1, 10), "", "",
         "light falls off by 1 + v1 r² + v2 r⁴, r = 1 in the corners; the solve's unless given",
         [](Scene& s, const SettingValue& v) { s.effects.vignette->v1 = v.number; }},
        {vignette, "v2", between(number, -1, 10), "", "", "likewise; 0 where only `v1` is given",
         [](Scene& s, const SettingValue& v) { s.effects.vignette->v2 = v.number; }},
    };
    rows.insert(rows.end(), added.begin(), added.end());
}

}  // namespace matchlight
