// Rows of the scene file's table for each effect: a word, or a table of its settings.
#include "scene/effect_schema.h"

namespace matchlight {
namespace {

using enum SettingKind;

SettingDomain of_kind(SettingKind kind) {
    return {.kind = kind, .choices = {}};
}
SettingDomain between(SettingKind kind, double lowest, double highest) {
    return {.kind = kind, .lowest = lowest, .highest = highest, .choices = {}};
}
SettingDomain one_of(std::vector<std::string_view> choices) {
    return {.kind = choice, .choices = std::move(choices)};
}

}  // namespace

const std::vector<SceneSection>& effect_sections() {
    static const std::vector<SceneSection> sections = {
        {"effects", SectionUse::always,
         "Effects of the camera on the virtual light: each `\"off\"`, `\"auto\"` or a table.", nullptr},
        {"effects.bloom", SectionUse::nested, "Bright light spills around itself.",
         [](Scene& s) { s.effects.bloom.emplace(); }},
    };
    return sections;
}

const std::vector<Setting>& effect_settings() {
    static const std::vector<Setting> settings = {
        {"effects", "bloom", of_kind(effect), "", "\"off\"", "bright light spills around itself", nullptr},
        {"effects", "glare", of_kind(left_out), "", "\"off\"", "off", nullptr},
        {"effects", "exposure", of_kind(left_out), "", "\"off\"", "off (the footage's own exposure is always met)",
         nullptr},
        {"effects", "depth_of_field", of_kind(left_out), "", "\"off\"", "off", nullptr},
        {"effects", "motion_blur", of_kind(left_out), "", "\"off\"", "off", nullptr},
        {"effects", "grain", of_kind(left_out), "", "\"off\"", "off", nullptr},
        {"effects", "vignette", of_kind(left_out), "", "\"off\"", "off", nullptr},
        {"effects", "chromatic_aberration", of_kind(left_out), "", "\"off\"", "off", nullptr},

        {"effects.bloom", "level", one_of({"classic", "pyramid", "reference"}), "", "\"pyramid\"", "how it is computed",
         [](Scene& s, const SettingValue& v) { s.effects.bloom->level = static_cast<BloomLevel>(v.choice); }},
        {"effects.bloom", "threshold", between(number, 0, 1e6), "plate-linear", "1", "light below it does not spill",
         [](Scene& s, const SettingValue& v) { s.effects.bloom->threshold = v.number; }},
        {"effects.bloom", "knee", between(number, 0, 1), "", "0.5",
         "share of the threshold over which spilling sets in",
         [](Scene& s, const SettingValue& v) { s.effects.bloom->knee = v.number; }},
        {"effects.bloom", "strength", between(number, 0, 100), "", "0.2", "times what spills",
         [](Scene& s, const SettingValue& v) { s.effects.bloom->strength = v.number; }},
        {"effects.bloom", "radius", between(number, 0.001, 1), "frame heights", "0.08",
         "standard deviation of the widest spread",
         [](Scene& s, const SettingValue& v) { s.effects.bloom->radius = v.number; }},
    };
    return settings;
}

}  // namespace matchlight
