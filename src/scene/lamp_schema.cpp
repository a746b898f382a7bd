// A lamp is the last of the scene's when its settings are read.
#include "scene/lamp_schema.h"

#include <algorithm>

#include <fmt/format.h>

#include "scene/setting_domains.h"

namespace matchlight {
namespace {

using enum SettingKind;

LampSettings& lamp_of(Scene& scene) {
    return scene.lamps.back();
}

}  // namespace

const std::vector<Setting>& lamp_settings() {
    static const std::vector<Setting> settings = {
        {lamp_section, "type", one_of({"point", "directional", "spot"}), "", must_be_given, "what shines",
         [](Scene& s, const SettingValue& v) { lamp_of(s).type = static_cast<LampType>(v.choice); }},
        {lamp_section, "color", between(color, 0, 1e6), "", "[1, 1, 1]", "scene-linear; multiplies the intensity",
         [](Scene& s, const SettingValue& v) { lamp_of(s).color = v.vector; }},
        {lamp_section, "intensity", between(number, 0, 1e9), "probe units", "1",
         "irradiance of what faces the light: 1 m away from a point or a spot, anywhere under a directional light",
         [](Scene& s, const SettingValue& v) { lamp_of(s).intensity = v.number; }},
        {lamp_section, "position", between(vector, -1e6, 1e6), "m", "", "of a point or a spot, which need one",
         [](Scene& s, const SettingValue& v) { lamp_of(s).position_m = v.vector; }},
        {lamp_section, "direction", between(vector, -1e6, 1e6), "", "",
         "in which the light of a spot or a directional light goes; straight down unless given",
         [](Scene& s, const SettingValue& v) { lamp_of(s).direction = v.vector; }},
        {lamp_section, "inner_cone_deg", between(number, 0, 90), "deg", "",
         "of a spot: all of its light is within this angle of its direction; 0 unless given",
         [](Scene& s, const SettingValue& v) { lamp_of(s).inner_cone_deg = v.number; }},
        {lamp_section, "outer_cone_deg", between(number, 0, 90), "deg", "",
         "of a spot: none of its light is beyond this angle; 45 unless given",
         [](Scene& s, const SettingValue& v) { lamp_of(s).outer_cone_deg = v.number; }},
        {lamp_section, "range", above(number, 0, 1e6), "m", "",
         "of a point or a spot: its light fades to none there, as glTF has it; endless unless given",
         [](Scene& s, const SettingValue& v) { lamp_of(s).range_m = v.number; }},
        {lamp_section, "radius", between(number, 0, 1e3), "m", "",
         "of the ball that shines: soft shadows and wider highlights; 0, hard shadows, unless given",
         [](Scene& s, const SettingValue& v) { lamp_of(s).radius_m = v.number; }},
        {lamp_section, "angle_deg", between(number, 0, 90), "deg", "",
         "likewise of a directional light: the disc's diameter; the sun's is 0.53",
         [](Scene& s, const SettingValue& v) { lamp_of(s).angle_deg = v.number; }},
        {lamp_section, "casts_shadow", of_kind(boolean), "", "true", "objects stand in its light",
         [](Scene& s, const SettingValue& v) { lamp_of(s).casts_shadow = v.boolean; }},
        {lamp_section, "in_footage", of_kind(boolean), "", "",
         "the lamp is real: the footage holds its light, the probe does not, and objects take it from the surface; "
         "false: it is virtual and lights the surface, too; true unless given where the scene has no probe",
         [](Scene& s, const SettingValue& v) { lamp_of(s).in_footage = v.boolean; }},
    };
    return settings;
}

bool lit_by_lamps_alone(const Scene& scene) {
    if (scene.probe || scene.lamps.empty()) return false;
    return scene.camera.has_value() ||
           std::ranges::any_of(scene.lamps, [](const LampSettings& lamp) { return lamp.in_footage.value_or(true); });
}

void check_lamp(const SceneSource& source, const LampSettings& lamp, const toml::table& table) {
    const bool is_placed = lamp.type != LampType::directional;
    const bool is_aimed = lamp.type != LampType::point;
    const bool is_spot = lamp.type == LampType::spot;
    struct Use {
        std::string_view key;
        bool of_type;
    };
    for (const Use& use : {Use{"position", is_placed}, Use{"direction", is_aimed}, Use{"inner_cone_deg", is_spot},
                           Use{"outer_cone_deg", is_spot}, Use{"range", is_placed}, Use{"radius", is_placed},
                           Use{"angle_deg", !is_placed}}) {
        const toml::node* node = table.get(use.key);
        if (node != nullptr && !use.of_type) {
            source.fail(*node,
                        fmt::format("'{}' in [light] is of no use to a {} light", use.key,
                                    table.get("type")->value_or(std::string_view("such"))),
                        "leave it out");
        }
    }
    if (is_placed && !table.contains("position"))
        source.fail(table, "'position' is missing in [light]: where the light stands");
    if (lamp.direction.isZero(0)) {
        source.fail(*table.get("direction"), "'direction' in [light] has no direction",
                    "give [0, 0, -1] for straight down");
    }
    if (is_spot && lamp.inner_cone_deg > lamp.outer_cone_deg) {
        source.fail(table,
                    fmt::format("'inner_cone_deg' in [light] is {:g}, more than 'outer_cone_deg', {:g}",
                                lamp.inner_cone_deg, lamp.outer_cone_deg),
                    "give it at most the outer one's angle");
    }
}

}  // namespace matchlight
