// Settings of what the scene lays on an object's surface, one row each.
#include "scene/surface_detail_schema.h"

#include "scene/setting_domains.h"

namespace matchlight {
namespace {

using enum SettingKind;

SurfaceDetail& detail_of(Scene& scene) {
    return scene.objects.back().material.detail;
}
PatternSettings& pattern_of(Scene& scene) {
    return *detail_of(scene).pattern;
}
PictureLayer& layer_of(Scene& scene) {
    return detail_of(scene).layers.back();
}

}  // namespace

const std::vector<SceneSection>& surface_detail_sections() {
    static const std::vector<SceneSection> sections = {
        {"object.material.pattern", SectionUse::nested,
         "Colours that a formula lays over the base colour, filtered over what a pixel covers.",
         [](Scene& s) { detail_of(s).pattern.emplace(); }},
        {"object.material.layers", SectionUse::nested,
         "Pictures over the base colour, each over those before it: MT(n) = T(n)·alpha + MT(n−1)·(1 − alpha).",
         [](Scene& s) { detail_of(s).layers.emplace_back(); }},
    };
    return sections;
}

const std::vector<Setting>& surface_detail_settings() {
    constexpr std::string_view material = "object.material", pattern = "object.material.pattern",
                               layers = "object.material.layers";
    static const std::vector<Setting> settings = {
        {material, "normal_map", of_kind(input_file), "", "",
         "picture of normals in tangent space, as glTF has them, in place of the model's",
         [](Scene& s, const SettingValue& v) { detail_of(s).normal_map = v.path; }},
        {material, "height_map", of_kind(input_file), "", "",
         "picture of heights: white is the surface, black is carved `height` below it; 8 or 16 bit, or EXR from 0 to 1",
         [](Scene& s, const SettingValue& v) { detail_of(s).relief.height_map = v.path; }},
        {material, "height", between(number, 0, 1000), "m", "0", "from the map's white down to its black; 0: no relief",
         [](Scene& s, const SettingValue& v) { detail_of(s).relief.depth_m = v.number; }},
        {material, "relief", one_of({"bump", "parallax", "occlusion", "relief", "cone_step", "sphere_tracing"}), "",
         "\"relief\"",
         "how heights are shown: shading alone (bump), moved by one look (parallax), or by a search along the ray; "
         "outlines stay flat",
         [](Scene& s, const SettingValue& v) { detail_of(s).relief.method = static_cast<ReliefMethod>(v.choice); }},
        {material, "relief_steps", between(integer, 1, 1024), "", "32", "of the search along the ray, at most",
         [](Scene& s, const SettingValue& v) { detail_of(s).relief.steps = static_cast<int>(v.integer); }},
        {material, "uv_scale", above(number, 0, 1e4), "", "1",
         "how often the pictures on the object repeat where they would lie once",
         [](Scene& s, const SettingValue& v) { detail_of(s).uv_scale = v.number; }},
        {material, "texture_filter", one_of({"nearest", "linear", "mipmapped"}), "", "",
         "how the object's pictures are read; as the model says unless given",
         [](Scene& s, const SettingValue& v) { detail_of(s).sampling.filter = static_cast<PictureFilter>(v.choice); }},
        {material, "texture_wrap", one_of({"repeat", "clamp", "mirror"}), "", "", "likewise, beyond their edges",
         [](Scene& s, const SettingValue& v) { detail_of(s).sampling.wrap = static_cast<PictureWrap>(v.choice); }},
        {material, "anisotropy", between(integer, 1, 16), "", "",
         "likewise: how much longer than wide a pixel may lie on them and still be read as long; goes with mipmapped",
         [](Scene& s, const SettingValue& v) { detail_of(s).sampling.anisotropy = static_cast<int>(v.integer); }},
        {material, "pattern", of_kind(section), "", "", "colours by a formula, which multiply the base colour",
         nullptr},
        {material, "layers", of_kind(sections), "", "", "pictures one over the other, over the base colour", nullptr},

        {pattern, "kind", one_of({"square_wave", "checker", "noise", "wood", "marble"}), "", must_be_given,
         "what is drawn",
         [](Scene& s, const SettingValue& v) { pattern_of(s).kind = static_cast<PatternKind>(v.choice); }},
        {pattern, "space", one_of({"object", "uv"}), "", "\"object\"",
         "in the model's own axes, or by its texture coordinates",
         [](Scene& s, const SettingValue& v) { pattern_of(s).space = static_cast<PatternSpace>(v.choice); }},
        {pattern, "color", between(color, 0, 1), "", "[1, 1, 1]", "scene-linear",
         [](Scene& s, const SettingValue& v) { pattern_of(s).color = color_of(v); }},
        {pattern, "second_color", between(color, 0, 1), "", "[0, 0, 0]", "scene-linear",
         [](Scene& s, const SettingValue& v) { pattern_of(s).second_color = color_of(v); }},
        {pattern, "middle_color", between(color, 0, 1), "", "",
         "of noise, wood and marble, between the two; their mean unless given",
         [](Scene& s, const SettingValue& v) { pattern_of(s).middle_color = color_of(v); }},
        {pattern, "frequency", above(number, 0, 1e6), "1/unit of the space", "8", "periods of the pattern",
         [](Scene& s, const SettingValue& v) { pattern_of(s).frequency = v.number; }},
        {pattern, "direction", between(vector, -1e6, 1e6), "", "[1, 0, 0]",
         "across the stripes of a square wave and the veins of marble, along the trunk of wood; any length but 0",
         [](Scene& s, const SettingValue& v) {
             pattern_of(s).direction = {v.vector.x(), v.vector.y(), v.vector.z()};
         }},
        {pattern, "share", between(number, 0, 1), "", "0.5", "of a square wave's period that has the first colour",
         [](Scene& s, const SettingValue& v) { pattern_of(s).share = v.number; }},
        {pattern, "octaves", between(integer, 1, 12), "", "4", "of the noise in it, each of twice the frequency",
         [](Scene& s, const SettingValue& v) { pattern_of(s).octaves = static_cast<int>(v.integer); }},
        {pattern, "turbulence", between(number, 0, 100), "periods", "1", "how far noise bends wood and marble",
         [](Scene& s, const SettingValue& v) { pattern_of(s).turbulence = v.number; }},
        {pattern, "filtered", of_kind(boolean), "", "true", "false: looked up at the pixel's middle, which aliases",
         [](Scene& s, const SettingValue& v) { pattern_of(s).filtered = v.boolean; }},

        {layers, "texture", of_kind(input_file), "", must_be_given, "picture (PNG, JPEG, …)",
         [](Scene& s, const SettingValue& v) { layer_of(s).texture = v.path; }},
        {layers, "alpha", between(number, 0, 1), "", "1", "how much of it is seen; times the picture's own opacity",
         [](Scene& s, const SettingValue& v) { layer_of(s).alpha = v.number; }},
        {layers, "uv_scale", above(number, 0, 1e4), "", "1", "how often it repeats for once that the others do",
         [](Scene& s, const SettingValue& v) { layer_of(s).uv_scale = v.number; }},
    };
    return settings;
}

}  // namespace matchlight
