// The settings of a scene file, one row each, and the Markdown made from them.
#include "scene/scene_schema.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "scene/camera_schema.h"
#include "scene/classic_schema.h"
#include "scene/effect_schema.h"
#include "scene/lamp_schema.h"
#include "scene/object_motion_schema.h"
#include "scene/setting_domains.h"
#include "scene/sphere_schema.h"
#include "scene/surface_detail_schema.h"

namespace matchlight {
namespace {

/// A tag's place is known as soon as one part of it is given; the other parts are 0.
RigidTransform& place_of(Scene& scene) {
    auto& place = scene.tags.rig.back().world_from_tag;
    if (!place) place = RigidTransform::Identity();
    return *place;
}

MaterialOverride& material_of(Scene& scene) {
    return scene.objects.back().material;
}

const std::vector<SceneSection> footage_sections = {
    {"footage", SectionUse::optional, "The recorded video.", nullptr},
    {"tags", SectionUse::optional, "The AprilTags in the footage.", nullptr},
    {"tags.rig", SectionUse::nested, "One entry a tag.", [](Scene& s) { s.tags.rig.emplace_back(); }},
};

const std::vector<SceneSection> shot_sections = {
    {"light", SectionUse::optional, "The light probe.", [](Scene& s) { s.probe.emplace(); }},
    {lamp_section, SectionUse::nested,
     "An analytic light, one `[[light]]` each, beside the probe or instead of it. In a file that has some, the probe "
     "is "
     "one of the `[[light]]`, the one without a type.",
     [](Scene& s) { s.lamps.emplace_back(); }},
    {"object", SectionUse::repeated, "A virtual object, one `[[object]]` each.",
     [](Scene& s) { s.objects.emplace_back(); }},
    {"object.sphere", SectionUse::nested, "How the columns of the file that `spheres` names become spheres.", nullptr},
    {"object.keys", SectionUse::nested,
     "Where the object is at some frames; a smooth curve between them (Catmull-Rom), at rest beyond. What a key leaves "
     "out is as the object has it.",
     begin_object_key},
    {"object.spin", SectionUse::nested, "A steady turn about an axis through the object's origin.",
     [](Scene& s) { s.objects.back().spin.emplace(); }},
    {"object.material", SectionUse::nested, "Overrides of the materials in the model's file.", nullptr},
    {"surface", SectionUse::always,
     "The real surface that catches shadows; without footage there is none unless this section is given.", nullptr},
    {"quality", SectionUse::always, "Error against run time.", nullptr},
    {"output", SectionUse::always, "How the result is encoded.", nullptr},
};

// The order of the words in a choice is the order of the enumerators it is cast to.
using enum SettingKind;
const std::vector<Setting> own_settings = {
    {"footage", "video", of_kind(footage), "", must_be_given,
     "video file, or an image sequence such as `frames/%04d.jpg`",
     [](Scene& s, const SettingValue& v) { s.footage.video = v.path; }},
    {"footage", "camera", of_kind(input_file), "", "",
     "the lens: OpenCV's YAML, as `calibrate` writes it; unless given, `track` finds it with the path",
     [](Scene& s, const SettingValue& v) { s.footage.camera = v.path; }},
    {"footage", "solve", of_kind(any_file), "", "",
     "written by `track`, read by `render`; beside the scene under its name unless given",
     [](Scene& s, const SettingValue& v) { s.footage.solve = v.path; }},
    {"footage", "response", input_file_or({"solve"}), "", "",
     "the camera's response curve; `\"solve\"`: `track` fits one to the tags; sRGB unless given",
     [](Scene& s, const SettingValue& v) {
         s.footage.solve_response = !v.text.empty();
         if (v.text.empty()) s.footage.response = v.path;
     }},
    {"footage", "refine_lens", one_of({"auto", "off", "on"}), "", "\"auto\"",
     "`track` corrects the calibrated lens: where the clip's evidence is clear, never, or in any case",
     [](Scene& s, const SettingValue& v) { s.footage.refine_lens = static_cast<LensRefinement>(v.choice); }},
    {"footage",
     "readout",
     {.kind = measure, .lowest = 0, .highest = 1, .choices = {"solve"}},
     "s",
     "0",
     "rolling shutter: time from the first row to the last; `track` finds it where it is \"solve\"",
     [](Scene& s, const SettingValue& v) {
         s.footage.solve_readout = !v.text.empty();
         s.footage.readout_s = v.number;
     }},
    {"footage", "fps", above(number, 0, 10000), "1/s", "", "frame rate of an image sequence; 25 unless given",
     [](Scene& s, const SettingValue& v) { s.footage.fps = v.number; }},
    {"footage", "color_matrix", one_of({"bt601", "bt709", "bt2020"}), "", "", "overrides the file's tag",
     [](Scene& s, const SettingValue& v) { s.footage.color_matrix = v.text; }},
    {"footage", "color_range", one_of({"limited", "full"}), "", "", "overrides the file's tag",
     [](Scene& s, const SettingValue& v) { s.footage.color_range = v.text; }},
    {"footage", "ocio_space", of_kind(text), "", "",
     "the footage's colour space by its name in an OpenColorIO config, in place of `response` and the file's tags",
     [](Scene& s, const SettingValue& v) { s.footage.ocio_space = v.text; }},
    {"footage", "ocio_config", of_kind(input_file), "", "",
     "that config (`config.ocio`); the one that `$OCIO` names unless given",
     [](Scene& s, const SettingValue& v) { s.footage.ocio_config = v.path; }},
    {"footage", "matte", of_kind(footage), "", "",
     "video or pictures (`matte_%04d.png`), one for every frame: white is real and in front of everything virtual, "
     "such "
     "as a hand over the tags; grey is so in part",
     [](Scene& s, const SettingValue& v) { s.footage.matte = v.path; }},
    {"footage", "depth", of_kind(footage), "", "",
     "how far what the footage shows is along the camera's z, one for every frame: EXR pictures, 16-bit PNG or a "
     "video; "
     "what is nearer than virtual things hides them; 0 is not known, and hides nothing",
     [](Scene& s, const SettingValue& v) { s.footage.depth = v.path; }},
    {"footage", "depth_scale", above(number, 0, 1e6), "m", "",
     "of a unit of `depth`; 1 for EXR, else 0.001 unless given",
     [](Scene& s, const SettingValue& v) { s.footage.depth_scale = v.number; }},

    {"tags", "family", one_of({"tag36h11", "tag25h9", "tag16h5", "tagStandard41h12", "tagCircle21h7"}), "",
     "\"tag36h11\"", "AprilTag family", [](Scene& s, const SettingValue& v) { s.tags.family = v.text; }},
    {"tags", "rig", of_kind(sections), "", must_be_given, "the tags that belong together", nullptr},
    {"tags", "white_albedo", above(number, 0, 1), "", "0.8", "reflectance of the tags' paper, the grey card",
     [](Scene& s, const SettingValue& v) { s.tags.white_albedo = v.number; }},
    {"tags", "black_albedo", between(number, 0, 1), "", "0.04", "reflectance of the tags' ink",
     [](Scene& s, const SettingValue& v) { s.tags.black_albedo = v.number; }},

    {"tags.rig", "id", between(integer, 0, 100000), "", must_be_given, "the tag's number in its family",
     [](Scene& s, const SettingValue& v) { s.tags.rig.back().id = static_cast<int>(v.integer); }},
    {"tags.rig", "size", above(number, 0, 1000), "m", must_be_given,
     "distance between detection corners (tag36h11: side of the black border)",
     [](Scene& s, const SettingValue& v) { s.tags.rig.back().size_m = v.number; }},
    {"tags.rig", "x", between(number, -1e6, 1e6), "m", "", "centre of the tag, where known",
     [](Scene& s, const SettingValue& v) { place_of(s).translation().x() = v.number; }},
    {"tags.rig", "y", between(number, -1e6, 1e6), "m", "", "as x",
     [](Scene& s, const SettingValue& v) { place_of(s).translation().y() = v.number; }},
    {"tags.rig", "z", between(number, -1e6, 1e6), "m", "", "as x",
     [](Scene& s, const SettingValue& v) { place_of(s).translation().z() = v.number; }},
    {"tags.rig", "rotation_deg", between(rotation, -36000, 36000), "deg", "", "about z, or about x, then y, then z",
     [](Scene& s, const SettingValue& v) { place_of(s).linear() = rotation_from_degrees(v.vector); }},

    {"light", "probe", of_kind(input_file), "", must_be_given, "HDR image of the light, .exr or .hdr",
     [](Scene& s, const SettingValue& v) { s.probe->path = v.path; }},
    {"light", "mapping", one_of({"latlong", "angular", "mirrorball", "cube"}), "", "",
     "recognised by shape and metadata unless given",
     [](Scene& s, const SettingValue& v) { s.probe->mapping = static_cast<ProbeMapping>(v.choice); }},
    {"light", "rotation_deg", between(number, -36000, 36000), "deg", "0",
     "turns the light counter-clockwise seen from above",
     [](Scene& s, const SettingValue& v) { s.probe->placement.rotation_deg = v.number; }},
    {"light", "exposure_ev", between(number, -64, 64), "EV", "0", "radiance × 2^ev",
     [](Scene& s, const SettingValue& v) { s.probe->placement.exposure_ev = v.number; }},
    {"light", "place", between(vector, -1e6, 1e6), "m", "", "where in the world the probe was taken",
     [](Scene& s, const SettingValue& v) { s.probe->place_m = v.vector; }},

    {"object", "model", of_kind(input_file), "", "", "glTF 2.0 (.gltf, .glb), OBJ, PLY or STL",
     [](Scene& s, const SettingValue& v) { s.objects.back().model = v.path; }},
    {"object", "shape", one_of({"sphere", "box", "plane", "torus", "cylinder", "cone", "teapot"}), "", "",
     "instead of a model", [](Scene& s, const SettingValue& v) { s.objects.back().shape = v.text; }},
    {"object", "spheres", of_kind(input_file), "", "",
     "a set of spheres instead of a model: XYZ, PDB, mmCIF, GRO, CSV, VTK, VTP, PLY or bgeo",
     [](Scene& s, const SettingValue& v) { s.objects.back().spheres = v.path; }},
    {"object", "sphere", of_kind(section), "", "", "how the file's columns become spheres", nullptr},
    {"object", "name", of_kind(text), "", "", "for layers and messages; the file's stem unless given",
     [](Scene& s, const SettingValue& v) { s.objects.back().name = v.text; }},
    {"object", "translate", between(vector, -1e6, 1e6), "m", "[0, 0, 0]", "last of the three: scale, rotate, translate",
     [](Scene& s, const SettingValue& v) { s.objects.back().translate_m = v.vector; }},
    {"object", "rotate_deg", between(rotation, -36000, 36000), "deg", "[0, 0, 0]",
     "about z, or about x, then y, then z of the world",
     [](Scene& s, const SettingValue& v) { s.objects.back().rotate_deg = v.vector; }},
    {"object", "scale", above(scale, 0, 1e6), "", "[1, 1, 1]", "one number, or one an axis",
     [](Scene& s, const SettingValue& v) { s.objects.back().scale = v.vector; }},
    {"object", "keys", of_kind(sections), "", "", "how it moves: these places at some frames", nullptr},
    {"object", "spin", of_kind(section), "", "", "it turns steadily", nullptr},
    {"object", "parent_tag", between(integer, 0, 100000), "", "", "coordinates are that tag's instead of the world's",
     [](Scene& s, const SettingValue& v) { s.objects.back().parent_tag = static_cast<int>(v.integer); }},
    {"object", "reflection", one_of({"cube", "sphere_map"}), "", "\"cube\"", "form in which the probe is reflected",
     [](Scene& s, const SettingValue& v) { s.objects.back().reflection = static_cast<ReflectionForm>(v.choice); }},
    {"object", "casts_shadow", of_kind(boolean), "", "true", "on the surface",
     [](Scene& s, const SettingValue& v) { s.objects.back().casts_shadow = v.boolean; }},
    {"object", "lights", between(number, 0, 1e9), "probe units", "1",
     "a candela, or a lux, of the lights in the model's own file (KHR_lights_punctual): they are virtual; 0: none",
     [](Scene& s, const SettingValue& v) { s.objects.back().lights = v.number; }},
    {"object", "holdout", of_kind(boolean), "", "false",
     "it stands for a real thing in the footage: never drawn, it hides virtual objects behind it and catches their "
     "shadow",
     [](Scene& s, const SettingValue& v) { s.objects.back().holdout = v.boolean; }},
    {"object",
     "focus",
     {.kind = measure, .lowest = 1e-3, .highest = 1e9, .choices = {"sharp"}},
     "m",
     "",
     "blurred as if the lens were focused there, or never: at the level lens_samples of depth of field",
     [](Scene& s, const SettingValue& v) {
         s.objects.back().focus =
             FocusOverride{v.text.empty() ? std::optional<double>(v.number) : std::optional<double>()};
     }},
    {"object", "material", of_kind(section), "", "", "overrides of the file's own materials", nullptr},

    {"object.material", "base_color", between(color, 0, 1), "", "", "scene-linear",
     [](Scene& s, const SettingValue& v) { material_of(s).base_color = color_of(v); }},
    {"object.material", "texture", of_kind(input_file), "", "",
     "picture of the base colour (PNG, JPEG, …), in place of the model's; `base_color` multiplies it",
     [](Scene& s, const SettingValue& v) { material_of(s).texture = v.path; }},
    {"object.material", "metallic", between(number, 0, 1), "", "", "0 dielectric, 1 metal",
     [](Scene& s, const SettingValue& v) { material_of(s).metallic = v.number; }},
    {"object.material", "roughness", between(number, 0, 1), "", "", "perceptual, as in glTF",
     [](Scene& s, const SettingValue& v) { material_of(s).roughness = v.number; }},
    {"object.material", "emissive", between(color, 0, 1e6), "probe units", "", "emitted radiance",
     [](Scene& s, const SettingValue& v) { material_of(s).emissive = color_of(v); }},
    {"object.material", "diffuse", between(color, 0, 1), "", "",
     "Od of the classic model, in place of metallic and roughness",
     [](Scene& s, const SettingValue& v) { material_of(s).diffuse = color_of(v); }},
    {"object.material", "specular", between(color, 0, 1), "", "", "Ks of the classic model, a mirror",
     [](Scene& s, const SettingValue& v) { material_of(s).specular = color_of(v); }},

    {"surface", "enabled", of_kind(boolean), "", "true", "false: nothing catches shadows",
     [](Scene& s, const SettingValue& v) { s.surface.present = v.boolean; }},
    {"surface", "z", between(number, -1e6, 1e6), "m", "0", "height of the surface in the world",
     [](Scene& s, const SettingValue& v) { s.surface.z_m = v.number; }},
    {"surface", "shadow", of_kind(boolean), "", "true", "objects shade it",
     [](Scene& s, const SettingValue& v) { s.surface.shadow = v.boolean; }},
    {"surface", "reflection", between(number, 0, 1), "", "0",
     "share of the light straight from above that it mirrors, more at grazing angles: it shows the objects; 0: it "
     "mirrors "
     "none",
     [](Scene& s, const SettingValue& v) { s.surface.reflection = v.number; }},
    {"surface", "reflection_roughness", between(number, 0, 1), "", "0.1",
     "of what it mirrors: 0 a mirror, 1 dull; perceptual, as in glTF",
     [](Scene& s, const SettingValue& v) { s.surface.reflection_roughness = v.number; }},

    {"quality", "level", one_of({"draft", "preview", "final", "reference"}), "", "\"final\"", "how exactly to render",
     [](Scene& s, const SettingValue& v) { s.quality = static_cast<QualityLevel>(v.choice); }},
    {"quality", "reflections", one_of({"environment", "plane", "rays"}), "", "",
     "what is near in what objects mirror: nothing, the real surface, or other objects, too; by the level unless given",
     [](Scene& s, const SettingValue& v) { s.reflections = static_cast<ReflectionLevel>(v.choice); }},
    {"quality", "bounce", of_kind(boolean), "", "",
     "light bounces between objects and onto the surface: needs rays; by the level unless given",
     [](Scene& s, const SettingValue& v) { s.bounce = v.boolean; }},
    {"quality", "sphere_edges", between(integer, 0, 16), "", "",
     "places along a drawn pixel's side that tell what covers it where spheres have edges; 0, 1: its middle; by the "
     "level unless given",
     [](Scene& s, const SettingValue& v) { s.sphere_edges = static_cast<int>(v.integer); }},
    {"quality", "sphere_detail", between(number, 0, 64), "drawn px", "",
     "opaque spheres of a smaller radius are drawn fewer and larger; 0: all are drawn; by the level unless given",
     [](Scene& s, const SettingValue& v) { s.sphere_detail_px = v.number; }},
    {"quality", "occlusion_divisions", between(integer, 0, 4), "", "",
     "light past other objects is told along the corners of an octahedron, divided so often: 6, 18, 66, 258 or 1026 "
     "directions; along those in which most of it comes, by the level, unless given",
     [](Scene& s, const SettingValue& v) { s.occlusion_divisions = static_cast<int>(v.integer); }},
    {"quality", "transparency",
     one_of({"lists", "peeling", "dual_peeling", "weighted_sum", "weighted_blended", "moments"}), "", "\"lists\"",
     "of spheres: all that a pixel meets, or layer by layer from the front or from both ends, all exact; or sums that "
     "keep no order",
     [](Scene& s, const SettingValue& v) { s.transparency = static_cast<TransparencyMethod>(v.choice); }},
    {"quality", "transparency_tolerance", above(number, 0, 64), "codes of 255", "1",
     "how far spheres that let light through may be off, where light behind them is up to three stops above white",
     [](Scene& s, const SettingValue& v) { s.transparency_tolerance = v.number; }},
    {"quality", "budget_ms", above(number, 0, 1e6), "ms", "",
     "time for a frame: levels are chosen within it, by the table that `report --calibrate-machine` made",
     [](Scene& s, const SettingValue& v) { s.budget_ms = v.number; }},

    {"output", "codec", one_of({"h264", "h265", "ffv1", "prores4444"}), "", "\"h264\"", "of video files",
     [](Scene& s, const SettingValue& v) { s.output.codec = v.text; }},
    {"output", "crf", between(integer, 0, 51), "", "",
     "h264 and h265: 0 lossless, 51 worst; the codec's own unless given",
     [](Scene& s, const SettingValue& v) { s.output.crf = static_cast<int>(v.integer); }},
    {"output", "pixel_format", of_kind(text), "", "", "FFmpeg's name; the footage's own unless given",
     [](Scene& s, const SettingValue& v) { s.output.pixel_format = v.text; }},
    {"output", "preset",
     one_of({"ultrafast", "superfast", "veryfast", "faster", "fast", "medium", "slow", "slower", "veryslow"}), "",
     "\"medium\"", "h264 and h265: faster or smaller",
     [](Scene& s, const SettingValue& v) { s.output.preset = v.text; }},
    {"output", "audio", of_kind(boolean), "", "true", "carry the sound over",
     [](Scene& s, const SettingValue& v) { s.output.audio = v.boolean; }},
};

template <class Row>
std::vector<Row> joined(const std::vector<Row>& rows, const std::vector<Row>& more) {
    std::vector<Row> all = rows;
    all.insert(all.end(), more.begin(), more.end());
    return all;
}

// Sections are read in this order: what is the default of later ones depends on there being a camera.
const std::vector<SceneSection> section_table =
    joined(joined(joined(joined(footage_sections, camera_sections()), shot_sections), surface_detail_sections()),
           effect_sections());
const std::vector<Setting> setting_table =
    joined(joined(joined(joined(joined(joined(joined(own_settings, surface_detail_settings()), classic_settings()),
                                       lamp_settings()),
                                sphere_settings()),
                         object_motion_settings()),
                  effect_settings()),
           camera_settings());

std::string_view type_name(SettingKind kind) {
    switch (kind) {
        case boolean:
            return "true or false";
        case integer:
            return "whole number";
        case number:
            return "number";
        case text:
            return "text";
        case choice:
            return "word";
        case measure:
            return "number";
        case color:
            return "[r, g, b]";
        case vector:
            return "[x, y, z]";
        case interval:
            return "[from, to]";
        case scale:
        case rotation:
            return "number or [x, y, z]";
        case input_file:
        case any_file:
            return "file";
        case footage:
            return "file or pattern";
        case section:
            return "table";
        case sections:
            return "array of tables";
        case effect:
            return "\"off\", \"auto\" or table";
        case left_out:
        case not_built:
            return "not in this version";
    }
    assert(false);
    return {};
}

/// Edit distance with swaps of neighbours (optimal string alignment; Damerau, A technique for computer detection and
/// correction of spelling errors, 1964).
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::vector<std::size_t>> distance(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) distance[i][0] = i;
    std::iota(distance[0].begin(), distance[0].end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = distance[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            distance[i][j] = std::min({distance[i - 1][j] + 1, distance[i][j - 1] + 1, replaced});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                distance[i][j] = std::min(distance[i][j], distance[i - 2][j - 2] + 1);
            }
        }
    }
    return distance[a.size()][b.size()];
}

}  // namespace

std::span<const SceneSection> scene_sections() {
    return section_table;
}

std::span<const Setting> scene_settings() {
    return setting_table;
}

const SceneSection* find_section(std::string_view name) {
    const auto found =
        std::find_if(section_table.begin(), section_table.end(), [&](const auto& s) { return s.name == name; });
    return found == section_table.end() ? nullptr : &*found;
}

const Setting* find_setting(std::string_view section_name, std::string_view key) {
    const auto found = std::find_if(setting_table.begin(), setting_table.end(),
                                    [&](const Setting& s) { return s.section == section_name && s.key == key; });
    return found == setting_table.end() ? nullptr : &*found;
}

std::string_view nearest_word(std::string_view word, std::span<const std::string_view> known) {
    assert(!known.empty());
    // A key nobody would type is compared by its beginning only, so that the table stays small.
    const std::string_view start = word.substr(0, 64);
    return *std::min_element(known.begin(), known.end(), [&](std::string_view a, std::string_view b) {
        return edit_distance(start, a) < edit_distance(start, b);
    });
}

std::string_view written_section(std::string_view name) {
    return name.ends_with("[]") ? name.substr(0, name.size() - 2) : name;
}

std::string describe(const SettingDomain& domain) {
    if (domain.kind == choice) return fmt::format("{}", fmt::join(domain.choices, ", "));
    std::string words(type_name(domain.kind));
    for (const std::string_view word : domain.choices) words += fmt::format(" or \"{}\"", word);
    if (std::isfinite(domain.lowest)) {
        words += fmt::format(", {} {}", domain.above_lowest ? "above" : "from", domain.lowest);
        if (std::isfinite(domain.highest)) words += fmt::format(" to {}", domain.highest);
    }
    return words;
}

std::string scene_schema_text() {
    std::string markdown;
    for (const SceneSection& one : section_table) {
        const std::string_view name = written_section(one.name);
        const bool is_array = one.use == SectionUse::repeated || name != one.name;
        markdown += fmt::format("### `{}{}{}`\n\n{}\n\n", is_array ? "[[" : "[", name, is_array ? "]]" : "]", one.help);
        markdown += "| key | value | unit | default | meaning |\n|---|---|---|---|---|\n";
        for (const Setting& setting : setting_table) {
            if (setting.section != one.name) continue;
            markdown += fmt::format("| `{}` | {} | {} | {} | {} |\n", setting.key, describe(setting.domain),
                                    setting.unit, setting.fallback, setting.help);
        }
        markdown += "\n";
    }
    return markdown;
}

}  // namespace matchlight
