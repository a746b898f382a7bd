// Rows of the scene file's table for each effect: a word, or a table of its settings.
#include "scene/effect_schema.h"

#include "scene/setting_domains.h"

namespace matchlight {
namespace {

using enum SettingKind;

GlareSettings& glare_of_all(Scene& scene) {
    return *scene.effects.glare;
}
GlareSettings& glare_of_dazzle(Scene& scene) {
    return *scene.effects.dazzle->glare;
}

/// The rows of a glare and of its aperture, for the glare that `place` finds.
template <GlareSettings& (*place)(Scene&)>
void add_glare_settings(std::vector<Setting>& rows, std::string_view section, std::string_view aperture) {
    const std::vector<Setting> added = {
        {section, "level", one_of({"classic", "streaks", "diffraction", "reference"}), "", "\"streaks\"",
         "how it is computed; classic: four diagonal streaks",
         [](Scene& s, const SettingValue& v) { place(s).level = static_cast<GlareLevel>(v.choice); }},
        {section, "threshold", between(number, 0, 1e6), "plate-linear", "2", "light below it makes no glare",
         [](Scene& s, const SettingValue& v) { place(s).threshold = v.number; }},
        {section, "knee", between(number, 0, 1), "", "0.25", "share of the threshold over which glare sets in",
         [](Scene& s, const SettingValue& v) { place(s).knee = v.number; }},
        {section, "strength", between(number, 0, 100), "", "0.2", "times the glare of all directions together",
         [](Scene& s, const SettingValue& v) { place(s).strength = v.number; }},
        {section, "directions", between(integer, 1, 64), "", "4", "streaks from each light",
         [](Scene& s, const SettingValue& v) { place(s).directions = static_cast<int>(v.integer); }},
        {section, "angle_deg", between(number, -36000, 36000), "deg", "45",
         "of the first streak, counter-clockwise from the picture's right",
         [](Scene& s, const SettingValue& v) { place(s).angle_deg = v.number; }},
        {section, "attenuation", between(number, 0, 0.999), "", "0.92",
         "of a streak's light from step to step, each 1/128 of the frame's height",
         [](Scene& s, const SettingValue& v) { place(s).attenuation = v.number; }},
        {section, "passes", between(integer, 1, 5), "", "3", "a streak is 4^passes steps long",
         [](Scene& s, const SettingValue& v) { place(s).passes = static_cast<int>(v.integer); }},
        {section, "size", between(number, 0.001, 1), "frame heights", "0.25",
         "how far the pattern of the level `diffraction` reaches",
         [](Scene& s, const SettingValue& v) { place(s).size = v.number; }},
        {section, "halo", between(number, 0, 100), "", "0", "strength of the lenticular halo",
         [](Scene& s, const SettingValue& v) { place(s).halo = v.number; }},
        {section, "aperture", of_kind(SettingKind::section), "", "", "of the level `diffraction`", nullptr},

        {aperture, "blades", between(integer, 0, 32), "", "6", "0: round",
         [](Scene& s, const SettingValue& v) { place(s).aperture.blades = static_cast<int>(v.integer); }},
        {aperture, "rotation_deg", between(number, -36000, 36000), "deg", "0", "counter-clockwise",
         [](Scene& s, const SettingValue& v) { place(s).aperture.rotation_deg = v.number; }},
        {aperture, "roundness", between(number, 0, 1), "", "0", "0: straight blades; 1: a circle",
         [](Scene& s, const SettingValue& v) { place(s).aperture.roundness = v.number; }},
        {aperture, "eyelashes", between(integer, 0, 1000), "", "0", "across the opening",
         [](Scene& s, const SettingValue& v) { place(s).aperture.eyelashes = static_cast<int>(v.integer); }},
        {aperture, "dust", between(integer, 0, 10000), "", "0", "specks on the lens",
         [](Scene& s, const SettingValue& v) { place(s).aperture.dust = static_cast<int>(v.integer); }},
        {aperture, "seed", between(integer, 0, 1e9), "", "1", "other lashes and other dust",
         [](Scene& s, const SettingValue& v) { place(s).aperture.seed = static_cast<int>(v.integer); }},
        {aperture, "f_number", between(number, 0.1, 1000), "", "",
         "with `pixel_pitch_um`: diffraction has its true size, whatever `size` is",
         [](Scene& s, const SettingValue& v) { place(s).aperture.f_number = v.number; }},
        {aperture, "pixel_pitch_um", between(number, 0.01, 10000), "µm", "", "of a pixel of the footage on the sensor",
         [](Scene& s, const SettingValue& v) { place(s).aperture.pixel_pitch_um = v.number; }},
        {aperture, "image", of_kind(input_file), "", "", "instead of blades: white lets light through",
         [](Scene& s, const SettingValue& v) { place(s).aperture.image = v.path; }},
    };
    rows.insert(rows.end(), added.begin(), added.end());
}

}  // namespace

const std::vector<SceneSection>& effect_sections() {
    static const std::vector<SceneSection> sections = {
        {"effects", SectionUse::always,
         "Effects of the camera on the virtual light: each `\"off\"`, `\"auto\"` or a table.", nullptr},
        {"effects.bloom", SectionUse::nested, "Bright light spills around itself.",
         [](Scene& s) { s.effects.bloom.emplace(); }},
        {"effects.glare", SectionUse::nested, "Bright light is drawn out into streaks or a diffraction pattern.",
         [](Scene& s) { s.effects.glare.emplace(); }},
        {"effects.glare.aperture", SectionUse::nested, "The opening of the lens.", nullptr},
        {"effects.dazzle", SectionUse::nested,
         "Bright reflections on virtual objects, apart from other light: `bloom` and `glare` spill them.",
         [](Scene& s) { s.effects.dazzle.emplace(); }},
        {"effects.dazzle.glare", SectionUse::nested, "As in `[effects.glare]`.",
         [](Scene& s) { s.effects.dazzle->glare.emplace(); }},
        {"effects.dazzle.glare.aperture", SectionUse::nested, "As in `[effects.glare.aperture]`.", nullptr},
        {"effects.exposure", SectionUse::nested, "How much light makes which code: the footage's own, or metered.",
         [](Scene& s) {
             s.effects.exposure.emplace();
             if (s.camera) s.effects.exposure->mode = ExposureMode::simulated;
         }},
        {"effects.depth_of_field", SectionUse::nested, "What is out of focus blurs.",
         [](Scene& s) { s.effects.depth_of_field.emplace(); }},
        {"effects.depth_of_field.bokeh", SectionUse::nested, "The shape of out-of-focus discs.", nullptr},
        {"effects.motion_blur", SectionUse::nested, "What moves while the shutter is open is smeared.",
         [](Scene& s) { s.effects.motion_blur.emplace(); }},
        {"effects.grain", SectionUse::nested, "Noise on what is virtual.", [](Scene& s) { s.effects.grain.emplace(); }},
        {"effects.chromatic_aberration", SectionUse::nested,
         "Red and blue are displaced along the radius, in proportion to it.",
         [](Scene& s) { s.effects.chromatic_aberration.emplace(); }},
        {"effects.softness", SectionUse::nested, "What is virtual is as soft as the footage.",
         [](Scene& s) { s.effects.softness.emplace(); }},
        {"effects.depth_cue", SectionUse::nested, "What is virtual fades to a colour with its distance.",
         [](Scene& s) { s.effects.depth_cue.emplace(); }},
        {"effects.color_transform", SectionUse::nested,
         "The codes of what is virtual are transformed, one row after the other.",
         [](Scene& s) { s.effects.color_transform.emplace(); }},
        {"effects.repeated_blur", SectionUse::nested, "A box blurs what is virtual along rows and columns, repeatedly.",
         [](Scene& s) { s.effects.repeated_blur.emplace(); }},
        {"effects.vignette", SectionUse::nested, "Light falls off towards the corners.",
         [](Scene& s) { s.effects.vignette.emplace(); }},
    };
    return sections;
}

namespace {

void add_exposure_settings(std::vector<Setting>& rows) {
    const std::vector<Setting> added = {
        {"effects.exposure", "mode", one_of({"matched", "simulated"}), "", "",
         "matched: the footage's own; simulated: metered frame by frame, the whole picture exposed anew; with footage "
         "matched unless given",
         [](Scene& s, const SettingValue& v) { s.effects.exposure->mode = static_cast<ExposureMode>(v.choice); }},
        {"effects.exposure", "sensor", one_of({"camera", "eye"}), "", "\"camera\"",
         "how fast it adapts: 0.5 s to light and 2 s to dark, or 0.1 s and 0.4 s",
         [](Scene& s, const SettingValue& v) {
             const AdaptationTimes& times = v.choice == 0 ? camera_adaptation : eye_adaptation;
             s.effects.exposure->to_light_s = times.to_light_s;
             s.effects.exposure->to_dark_s = times.to_dark_s;
         }},
        {"effects.exposure", "to_light_s", between(number, 0, 1e6), "s", "", "time constant, instead of the sensor's",
         [](Scene& s, const SettingValue& v) { s.effects.exposure->to_light_s = v.number; }},
        {"effects.exposure", "to_dark_s", between(number, 0, 1e6), "s", "", "time constant, instead of the sensor's",
         [](Scene& s, const SettingValue& v) { s.effects.exposure->to_dark_s = v.number; }},
        {"effects.exposure", "key", between(number, 0.01, 1), "", "0.18",
         "picture-linear light that the metered average becomes; usual: 0.18 to 0.72",
         [](Scene& s, const SettingValue& v) { s.effects.exposure->key = v.number; }},
        {"effects.exposure", "white", above(number, 0, 1e9), "picture-linear", "",
         "exposed light that becomes white; the brightest metered, and at least 1, unless given",
         [](Scene& s, const SettingValue& v) { s.effects.exposure->white = v.number; }},
        {"effects.exposure", "darkest_share", between(number, 0, 0.49), "", "0.05",
         "of the picture, left out of the average",
         [](Scene& s, const SettingValue& v) { s.effects.exposure->darkest_share = v.number; }},
        {"effects.exposure", "brightest_share", between(number, 0, 0.49), "", "0.02",
         "of the picture, left out of the average",
         [](Scene& s, const SettingValue& v) { s.effects.exposure->brightest_share = v.number; }},
        {"effects.exposure", "compensation_ev", between(number, -32, 32), "EV", "0", "added to what the meter says",
         [](Scene& s, const SettingValue& v) { s.effects.exposure->compensation_ev = v.number; }},
    };
    rows.insert(rows.end(), added.begin(), added.end());
}

std::vector<Setting> all_effect_settings() {
    std::vector<Setting> settings = {
        {"effects", "bloom", of_kind(effect), "", "\"off\"", "bright light spills around itself", nullptr},
        {"effects", "glare", of_kind(effect), "", "\"off\"", "bright light is drawn out", nullptr},
        {"effects", "dazzle", of_kind(effect), "", "\"off\"", "reflections on objects spill more, or otherwise",
         nullptr},
        {"effects", "exposure", of_kind(effect), "", "\"off\"",
         "auto: footage keeps its own (as with off), other scenes are metered frame by frame", nullptr},
        {"effects", "depth_of_field", of_kind(effect), "", "\"off\"",
         "objects blur as the solve, or the scene's camera, says that the lens does", nullptr},
        {"effects", "motion_blur", of_kind(effect), "", "\"off\"",
         "what moves while the shutter is open is smeared; the shutter is the solve's", nullptr},
        {"effects", "grain", of_kind(effect), "", "\"off\"", "what is virtual gets the noise of the footage", nullptr},
        {"effects", "vignette", of_kind(effect), "", "\"auto\"",
         "light falls off towards the corners as the solve says; without footage in the whole picture, if set by hand",
         [](Scene& s, const SettingValue&) { s.effects.vignette.reset(); }},
        {"effects", "chromatic_aberration", of_kind(effect), "", "\"off\"",
         "the lens displaces red and blue of what is virtual; the solve does not know it: give it by hand", nullptr},
        {"effects", "softness", of_kind(effect), "", "\"off\"",
         "what is virtual blurs as the footage's codec and resampling do", nullptr},
        {"effects", "depth_cue", of_kind(effect), "", "\"off\"",
         "what is virtual fades to a colour between two distances from the camera", nullptr},
        {"effects", "color_transform", of_kind(effect), "", "\"off\"",
         "brightness, contrast, hue, grey, tables and fades of what is virtual", nullptr},
        {"effects", "repeated_blur", of_kind(effect), "", "\"off\"", "what is virtual blurs by repeated boxes",
         nullptr},

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
        {"effects.bloom", "firefly_safe", of_kind(boolean), "", "true",
         "a very bright pixel that stands alone is held back; not at the level classic",
         [](Scene& s, const SettingValue& v) { s.effects.bloom->firefly_safe = v.boolean; }},

        {"effects.depth_cue", "near", between(number, 0, 1e6), "m", "1", "along the camera's z: it fades from here",
         [](Scene& s, const SettingValue& v) { s.effects.depth_cue->near_m = v.number; }},
        {"effects.depth_cue", "far", between(number, 0, 1e6), "m", "10", "to here, evenly",
         [](Scene& s, const SettingValue& v) { s.effects.depth_cue->far_m = v.number; }},
        {"effects.depth_cue", "color", between(color, 0, 1e6), "probe units", "[0, 0, 0]", "to this radiance",
         [](Scene& s, const SettingValue& v) { s.effects.depth_cue->color = color_of(v); }},
        {"effects.depth_cue", "strength", between(number, 0, 1), "", "1", "share of that colour at the far distance",
         [](Scene& s, const SettingValue& v) { s.effects.depth_cue->strength = v.number; }},

        {"effects.dazzle", "strength", between(number, 0, 1000), "", "1", "times what objects send to bloom and glare",
         [](Scene& s, const SettingValue& v) { s.effects.dazzle->strength = v.number; }},
        {"effects.dazzle", "glare", of_kind(SettingKind::section), "", "",
         "a glare of their own; as other light unless given", nullptr},
    };
    add_exposure_settings(settings);
    add_depth_of_field_settings(settings);
    add_motion_blur_settings(settings);
    add_sensor_settings(settings);
    add_color_transform_settings(settings);
    add_glare_settings<glare_of_all>(settings, "effects.glare", "effects.glare.aperture");
    add_glare_settings<glare_of_dazzle>(settings, "effects.dazzle.glare", "effects.dazzle.glare.aperture");
    return settings;
}

}  // namespace

const std::vector<Setting>& effect_settings() {
    static const std::vector<Setting> settings = all_effect_settings();
    return settings;
}

}  // namespace matchlight
