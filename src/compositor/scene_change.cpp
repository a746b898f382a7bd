// Settings are compared whole, less what can change: what is new in them counts as all until it is told here.
#include "compositor/scene_change.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

namespace matchlight {

namespace {

template <class Settings, class Value>
bool differs(const Settings& before, const Settings& after, Value Settings::*member) {
    return before.*member != after.*member;
}

/// An object with nothing said of it but what is loaded.
ObjectSettings loaded_part(const ObjectSettings& object) {
    const ObjectSettings plain;
    ObjectSettings part = object;
    part.name.clear();
    part.translate_m = plain.translate_m;
    part.rotate_deg = plain.rotate_deg;
    part.scale = plain.scale;
    part.keys.clear();
    part.spin.reset();
    part.animation = {.name = object.animation.name};
    part.parent_tag.reset();
    part.reflection = plain.reflection;
    part.casts_shadow = plain.casts_shadow;
    part.lights = plain.lights;
    part.focus.reset();
    part.material = {};
    part.material.texture = object.material.texture;
    part.material.detail = object.material.detail;
    part.material.shading.model = object.material.shading.model;  // it asks for lamps
    return part;
}

/// They hide the surface from the clip.
std::vector<ObjectSettings> holdouts_of(const Scene& scene) {
    std::vector<ObjectSettings> holdouts;
    std::ranges::copy_if(scene.objects, std::back_inserter(holdouts), &ObjectSettings::holdout);
    return holdouts;
}

bool loads_otherwise(const Scene& before, const Scene& after) {
    const auto probe_file = [](const Scene& scene) {
        return scene.probe ? std::pair(scene.probe->path, scene.probe->mapping)
                           : std::pair(std::filesystem::path(), std::optional<ProbeMapping>());
    };
    const bool of_clip = before.path != after.path || before.footage != after.footage ||
                         before.camera != after.camera || before.tags != after.tags ||
                         before.probe.has_value() != after.probe.has_value() ||
                         probe_file(before) != probe_file(after) || before.lamps.empty() != after.lamps.empty() ||
                         lit_by_lamps_alone(before) != lit_by_lamps_alone(after);
    const bool of_quality =
        before.quality != after.quality || before.reflections != after.reflections || before.bounce != after.bounce ||
        before.sphere_edges != after.sphere_edges || before.occlusion_divisions != after.occlusion_divisions ||
        before.sphere_detail_px != after.sphere_detail_px || before.budget_ms != after.budget_ms ||
        before.transparency != after.transparency || before.transparency_tolerance != after.transparency_tolerance;
    return of_clip || of_quality || !std::ranges::equal(before.objects, after.objects, {}, loaded_part, loaded_part);
}

bool differs_in_brightness_alone(const Scene& before, const Scene& after) {
    if (!before.probe || !after.probe || before.lamps != after.lamps) return false;
    ProbeSettings as_bright = *after.probe;
    as_bright.placement.exposure_ev = before.probe->placement.exposure_ev;
    return as_bright == *before.probe && after.lamps.empty() &&
           std::ranges::equal(before.objects, after.objects, {}, &ObjectSettings::lights, &ObjectSettings::lights);
}

}  // namespace

SceneChange change_between(const Scene& before, const Scene& after) {
    if (loads_otherwise(before, after)) return {.all = true};
    SceneChange change;
    for (std::size_t i = 0; i < before.objects.size(); ++i) {
        const ObjectSettings &was = before.objects[i], &is = after.objects[i];
        change.placement = change.placement || differs(was, is, &ObjectSettings::translate_m) ||
                           differs(was, is, &ObjectSettings::rotate_deg) || differs(was, is, &ObjectSettings::scale) ||
                           differs(was, is, &ObjectSettings::keys) || differs(was, is, &ObjectSettings::spin) ||
                           differs(was, is, &ObjectSettings::animation) ||
                           differs(was, is, &ObjectSettings::parent_tag);
        change.materials = change.materials || differs(was, is, &ObjectSettings::material);
        change.reflection = change.reflection || differs(was, is, &ObjectSettings::reflection);
        change.casting = change.casting || differs(was, is, &ObjectSettings::casts_shadow);
        change.light = change.light || differs(was, is, &ObjectSettings::lights);
    }
    change.surface_picture = before.surface.present != after.surface.present ||
                             before.surface.z_m != after.surface.z_m ||
                             before.effects.vignette != after.effects.vignette ||
                             !std::ranges::equal(holdouts_of(before), holdouts_of(after));
    change.light = change.light || before.probe != after.probe || before.lamps != after.lamps;
    change.brightness = change.light && differs_in_brightness_alone(before, after);
    change.surface = before.surface != after.surface;
    change.background = before.background != after.background;
    return change;
}

bool differ_in_spill_alone(const Scene& before, const Scene& after) {
    EffectSettings effects = after.effects;
    effects.bloom = before.effects.bloom;
    effects.glare = before.effects.glare;
    effects.dazzle = before.effects.dazzle;
    return effects == before.effects && before.objects == after.objects &&
           change_between(before, after) == SceneChange{};
}

}  // namespace matchlight
