// Rows of the scene file's table for the camera and the background of a scene without footage.
#include "scene/camera_schema.h"

#include "scene/setting_domains.h"

namespace matchlight {
namespace {

using enum SettingKind;

/// A side beyond which no rasteriser here takes a picture; nine hours at 30 frames a second.
constexpr double longest_side_px = 16384;
constexpr double most_frames = 1e6;

}  // namespace

const std::vector<SceneSection>& camera_sections() {
    static const std::vector<SceneSection> sections = {
        {"camera", SectionUse::optional, "The virtual camera of a scene without footage.",
         [](Scene& s) { s.camera.emplace(); }},
        {"camera.orbit", SectionUse::nested, "A circle about the vertical through a point.",
         [](Scene& s) { s.camera->orbit.emplace(); }},
        {"camera.keys", SectionUse::nested,
         "Where the camera is at some frames; a smooth curve between them (Catmull-Rom), at rest beyond.",
         [](Scene& s) { s.camera->keys.emplace_back(); }},
        {"camera.lens", SectionUse::nested, "What depth of field needs to know.",
         [](Scene& s) { s.camera->lens.emplace(); }},
        {"background", SectionUse::optional,
         "What stands behind the objects of a scene without footage; black unless given.", nullptr},
    };
    return sections;
}

const std::vector<Setting>& camera_settings() {
    static const std::vector<Setting> settings = {
        {"camera", "width", between(integer, 1, longest_side_px), "px", must_be_given, "of the picture",
         [](Scene& s, const SettingValue& v) { s.camera->width = static_cast<int>(v.integer); }},
        {"camera", "height", between(integer, 1, longest_side_px), "px", must_be_given, "of the picture",
         [](Scene& s, const SettingValue& v) { s.camera->height = static_cast<int>(v.integer); }},
        {"camera", "frames", between(integer, 1, most_frames), "", "1", "length of the clip",
         [](Scene& s, const SettingValue& v) { s.camera->frames = v.integer; }},
        {"camera", "fps", above(number, 0, 10000), "1/s", "25", "frame rate",
         [](Scene& s, const SettingValue& v) { s.camera->fps = v.number; }},
        {"camera", "vertical_fov_deg", between(number, 0.1, 170), "deg", "40",
         "angle from the top edge to the bottom edge",
         [](Scene& s, const SettingValue& v) { s.camera->vertical_fov_deg = v.number; }},
        {"camera", "orbit", of_kind(section), "", "", "how the camera moves: on a circle", nullptr},
        {"camera", "keys", of_kind(SettingKind::sections), "", "", "or: through these places", nullptr},
        {"camera", "lens", of_kind(section), "", "", "focal length follows from the angle of view", nullptr},
        {"camera", "exposure_ev", between(number, -64, 64), "EV", "0", "picture-linear light = light × 2^ev",
         [](Scene& s, const SettingValue& v) { s.camera->exposure_ev = v.number; }},

        {"camera.orbit", "target", between(vector, -1e6, 1e6), "m", "[0, 0, 0]", "in the picture's middle",
         [](Scene& s, const SettingValue& v) { s.camera->orbit->target_m = v.vector; }},
        {"camera.orbit", "radius", above(number, 0, 1e6), "m", must_be_given, "from the target to the camera",
         [](Scene& s, const SettingValue& v) { s.camera->orbit->radius_m = v.number; }},
        {"camera.orbit", "elevation_deg", between(number, -90, 90), "deg", "0", "above the horizontal",
         [](Scene& s, const SettingValue& v) { s.camera->orbit->elevation_deg = v.number; }},
        {"camera.orbit", "from_deg", between(number, -36000, 36000), "deg", "0",
         "at the first frame; counter-clockwise seen from above, 0 along +x",
         [](Scene& s, const SettingValue& v) { s.camera->orbit->from_deg = v.number; }},
        {"camera.orbit", "to_deg", between(number, -36000, 36000), "deg", "360", "at the last frame",
         [](Scene& s, const SettingValue& v) { s.camera->orbit->to_deg = v.number; }},

        {"camera.keys", "frame", between(integer, 0, most_frames), "", must_be_given, "counted from 0, ascending",
         [](Scene& s, const SettingValue& v) { s.camera->keys.back().frame = v.integer; }},
        {"camera.keys", "eye", between(vector, -1e6, 1e6), "m", must_be_given, "where the camera is",
         [](Scene& s, const SettingValue& v) { s.camera->keys.back().eye_m = v.vector; }},
        {"camera.keys", "target", between(vector, -1e6, 1e6), "m", must_be_given, "in the picture's middle",
         [](Scene& s, const SettingValue& v) { s.camera->keys.back().target_m = v.vector; }},

        {"camera.lens", "f_number", between(number, 0.1, 1000), "", "2.8", "focal length over the opening's width",
         [](Scene& s, const SettingValue& v) { s.camera->lens->f_number = v.number; }},
        {"camera.lens", "focus_distance_m", above(number, 0, 1e9), "m", must_be_given, "what is sharp",
         [](Scene& s, const SettingValue& v) { s.camera->lens->focus_distance_m = v.number; }},
        {"camera.lens", "sensor_width_mm", above(number, 0, 1000), "mm", "36", "of the picture's width",
         [](Scene& s, const SettingValue& v) { s.camera->lens->sensor_width_mm = v.number; }},

        {"background", "probe", of_kind(boolean), "", "", "the probe as skydome",
         [](Scene& s, const SettingValue& v) { s.background.probe = v.boolean; }},
        {"background", "color", between(color, 0, 1e9), "", "", "or: one colour, scene-linear",
         [](Scene& s, const SettingValue& v) { s.background.color = color_of(v); }},
        {"background", "image", of_kind(input_file), "", "",
         "or: a picture of the camera's size, sRGB or scene-linear (.exr, .hdr)",
         [](Scene& s, const SettingValue& v) { s.background.image = v.path; }},
    };
    return settings;
}

}  // namespace matchlight
