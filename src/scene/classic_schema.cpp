// The shading of the last of the scene's objects.
#include "scene/classic_schema.h"

#include "scene/setting_domains.h"

namespace matchlight {
namespace {

using enum SettingKind;

ClassicShading& shading_of(Scene& scene) {
    return scene.objects.back().material.shading;
}

}  // namespace

const std::vector<Setting>& classic_settings() {
    constexpr std::string_view material = "object.material";
    static const std::vector<Setting> settings = {
        {material, "shading", one_of({"physical", "phong", "blinn_phong", "cartoon", "gooch"}), "", "\"physical\"",
         "how it is shaded: all but the first by the scene's analytic lights or, without any, by the bright parts of "
         "its "
         "probe as lamps, the rest of the probe being ambient light; `diffuse` is Od, `specular` the highlight's Ks",
         [](Scene& s, const SettingValue& v) { shading_of(s).model = static_cast<ShadingModel>(v.choice); }},
        {material, "shininess", between(number, 1, 10000), "", "32",
         "exponent of that highlight: of the cosine to the mirrored light, with blinn_phong to the half vector",
         [](Scene& s, const SettingValue& v) { shading_of(s).shininess = v.number; }},
        {material, "tones", between(integer, 1, 256), "", "3", "of cartoon: steps from dark to light; 1: evenly lit",
         [](Scene& s, const SettingValue& v) { shading_of(s).tones = static_cast<int>(v.integer); }},
        {material, "cool", between(color, 0, 1), "", "[0, 0, 0.4]",
         "of gooch: away from the light, as a share of what white would be there",
         [](Scene& s, const SettingValue& v) { shading_of(s).cool = color_of(v); }},
        {material, "warm", between(color, 0, 1), "", "[0.4, 0.4, 0]", "of gooch: towards the light",
         [](Scene& s, const SettingValue& v) { shading_of(s).warm = color_of(v); }},
        {material, "cool_share", between(number, 0, 1), "", "0.2", "of the object's own colour, added to cool",
         [](Scene& s, const SettingValue& v) { shading_of(s).cool_share = v.number; }},
        {material, "warm_share", between(number, 0, 1), "", "0.6", "likewise to warm",
         [](Scene& s, const SettingValue& v) { shading_of(s).warm_share = v.number; }},
        {material, "outline", between(number, 0, 8), "px", "0",
         "width of lines inside its silhouette, its edges and its creases of more than 30 degrees; 0: none; with any "
         "shading",
         [](Scene& s, const SettingValue& v) { shading_of(s).outline_px = v.number; }},
        {material, "outline_color", between(color, 0, 1e6), "probe units", "[0, 0, 0]", "their radiance",
         [](Scene& s, const SettingValue& v) { shading_of(s).outline_color = color_of(v); }},
    };
    return settings;
}

}  // namespace matchlight
