// Rows of the scene file's table for sphere sets.
#include "scene/sphere_schema.h"

#include "scene/color_map.h"
#include "scene/setting_domains.h"

namespace matchlight {
namespace {

using enum SettingKind;

SphereSettings& sphere_of(Scene& scene) {
    return scene.objects.back().sphere;
}

}  // namespace

const std::vector<Setting>& sphere_settings() {
    constexpr std::string_view sphere = "object.sphere";
    static const std::vector<Setting> settings = {
        {sphere, "radius", above(number, 0, 1e30), "", "",
         "of all, in the file's units; else radius_column, the file's radii, or those of its elements",
         [](Scene& s, const SettingValue& v) { sphere_of(s).radius = v.number; }},
        {sphere, "radius_column", of_kind(text), "", "", "which column of the file is the radius",
         [](Scene& s, const SettingValue& v) { sphere_of(s).radius_column = v.text; }},
        {sphere, "radius_scale", above(number, 0, 1e30), "", "1", "multiplies all radii",
         [](Scene& s, const SettingValue& v) { sphere_of(s).radius_scale = v.number; }},
        {sphere, "color_column", of_kind(text), "", "",
         "which column becomes colours through color_map, or \"element\"; the file's own colours, or those of its "
         "elements, unless given",
         [](Scene& s, const SettingValue& v) { sphere_of(s).color_column = v.text; }},
        {sphere, "color_map", one_of(color_map_names()), "", "\"viridis\"", "of color_column",
         [](Scene& s, const SettingValue& v) { sphere_of(s).color_map = v.choice; }},
        {sphere, "color_range", between(interval, -1e30, 1e30), "", "",
         "values of color_column at the map's two ends; its least and greatest unless given",
         [](Scene& s, const SettingValue& v) {
             sphere_of(s).color_range = {v.vector.x(), v.vector.y()};
         }},
        {sphere, "opacity", between(number, 0, 1), "", "1", "of all; multiplies the file's own",
         [](Scene& s, const SettingValue& v) { sphere_of(s).opacity = v.number; }},
        {sphere, "opacity_column", of_kind(text), "", "", "which column is the opacity, 0 to 1",
         [](Scene& s, const SettingValue& v) { sphere_of(s).opacity_column = v.text; }},
        {sphere, "up", one_of({"z", "y"}), "", "\"z\"",
         "which of the file's axes is up; y is turned as models are, (x, y, z) → (x, −z, y)",
         [](Scene& s, const SettingValue& v) { sphere_of(s).up = static_cast<SphereAxes>(v.choice); }},
        {sphere, "halo", between(number, 0, 1), "", "0",
         "how dark it is behind the silhouettes of what is before; not of spheres that let light through",
         [](Scene& s, const SettingValue& v) { sphere_of(s).halo.strength = v.number; }},
        {sphere, "halo_width", above(number, 0, 10), "deg of view", "0.3", "how far the halo reaches",
         [](Scene& s, const SettingValue& v) { sphere_of(s).halo.width_deg = v.number; }},
        {sphere, "halo_depth", above(number, 0, 1e6), "m", "0.1",
         "how far behind a silhouette the halo is as dark as it gets",
         [](Scene& s, const SettingValue& v) { sphere_of(s).halo.depth_m = v.number; }},
        {sphere, "frame", between(integer, 0, 1e9), "", "0", "which frame of a trajectory, counted from 0",
         [](Scene& s, const SettingValue& v) { sphere_of(s).frame = v.integer; }},
    };
    return settings;
}

}  // namespace matchlight
