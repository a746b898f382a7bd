// What each quality level of the scene file means, in one place.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include "render/effects/bounce_light.h"
#include "render/effects/contact_shadow.h"
#include "render/effects/object_shadow.h"
#include "render/lamps.h"
#include "scene/scene_file.h"

namespace matchlight {

struct ReflectionSettings {
    ReflectionLevel level = ReflectionLevel::rays;
    int lobe_rays = 2;     // a sample of the picture, along the lobe of a rough surface, 1..64
    int bounces = 4;       // mirrors within mirrors, 1..16
    int surface_rays = 8;  // a pixel, where the real surface mirrors objects, 1..1024
};

struct Quality {
    int supersampling = 2;        // layer pixels along each side of a plate pixel, each with `samples` samples
    int samples = 1;              // multisampling; with small triangles a sample costs more than a pixel
    double sphere_detail_px = 0;  // smaller spheres are drawn fewer and larger (render/sphere_culling.h)
    int halo_step_px = 1;         // layer pixels between the places that halos of spheres look at
    int sphere_edge_places = 4;   // along a layer pixel's side where spheres have edges (render/sphere_edges.h)
    int mirror_face_px = 512;     // the reflection cube's sharpest level
    ContactShadowSettings shadow;
    ObjectShadowSettings object_shadow;
    ReflectionSettings reflection = {};
    BounceLightSettings bounce = {};
    // Levels of the camera's effects; each effect says what they are.
    QualityLevel bloom = QualityLevel::final_;
    QualityLevel glare = QualityLevel::final_;
    QualityLevel depth_of_field = QualityLevel::final_;
    QualityLevel motion_blur = QualityLevel::final_;
    QualityLevel sensor = QualityLevel::final_;  // what is done to the layer after lens and shutter
    LampQuality lamps = {};
};

/// Shadows of analytic lights: rays where the level's reflections trace them, maps elsewhere and of spheres.
inline LampQuality lamp_quality_of(QualityLevel level) {
    switch (level) {
        case QualityLevel::draft:
            return {.resolution = 256, .taps = 8, .rays = 0, .surface_points = 8};
        case QualityLevel::preview:
            return {.resolution = 512, .taps = 12, .rays = 0, .surface_points = 16};
        case QualityLevel::reference:
            return {.resolution = 2048, .taps = 64, .rays = 64, .surface_points = 512};
        case QualityLevel::final_:
            break;
    }
    return {};
}

inline Quality quality_of(QualityLevel level) {
    switch (level) {
        case QualityLevel::draft:
            return {1,
                    1,
                    0.5,
                    3,
                    0,
                    128,
                    {.directions = 16, .resolution = 256},
                    {.directions = 0},
                    {.level = ReflectionLevel::environment},
                    {.rays = 0},
                    level,
                    level,
                    level,
                    level,
                    level,
                    lamp_quality_of(level)};
        case QualityLevel::preview:
            return {1,
                    1,
                    0.5,
                    2,
                    4,
                    256,
                    {.directions = 32, .resolution = 512},
                    {.directions = 32, .resolution = 128},
                    {.level = ReflectionLevel::plane},
                    {.rays = 0},
                    level,
                    level,
                    level,
                    level,
                    level,
                    lamp_quality_of(level)};
        case QualityLevel::reference:
            return {
                4,
                4,
                0,
                1,
                4,
                1024,
                {.directions = 1024, .resolution = 2048, .lost_share = 0.0005},
                {.directions = 256, .resolution = 512},
                {.lobe_rays = 8, .bounces = 6, .surface_rays = 64},
                {.rays = 256, .surface_rays = 1024, .most_rays = 1'000'000'000, .bounces = 6, .surface_points = 192},
                level,
                level,
                level,
                level,
                level};
        case QualityLevel::final_:
            break;
    }
    return {2, 1, 0, 1, 4, 512, {.directions = 128, .resolution = 1024}, {}};
}

/// The same with reflections that meet no object, and without light that bounces.
inline Quality without_rays(Quality quality) {
    if (quality.reflection.level == ReflectionLevel::rays) quality.reflection.level = ReflectionLevel::plane;
    quality.bounce.rays = 0;
    return quality;
}

/// The same with what the scene says of rays and spheres in place of the level.
inline Quality with_choices_of(const Scene& scene, Quality quality) {
    if (scene.sphere_edges) quality.sphere_edge_places = *scene.sphere_edges;
    if (scene.sphere_detail_px) quality.sphere_detail_px = *scene.sphere_detail_px;
    if (scene.occlusion_divisions) quality.object_shadow.octahedron_divisions = scene.occlusion_divisions;
    if (scene.reflections) quality.reflection.level = *scene.reflections;
    if (scene.bounce && *scene.bounce != (quality.bounce.rays > 0))
        quality.bounce = *scene.bounce ? BounceLightSettings{} : BounceLightSettings{.rays = 0};
    return quality;
}

/// The levels with their names in scene files, cheapest first.
inline constexpr std::array<std::pair<std::string_view, QualityLevel>, 4> quality_levels{
    {{"draft", QualityLevel::draft},
     {"preview", QualityLevel::preview},
     {"final", QualityLevel::final_},
     {"reference", QualityLevel::reference}}};

constexpr std::string_view name_of(QualityLevel level) {
    return quality_levels[static_cast<std::size_t>(level)].first;
}
static_assert(name_of(QualityLevel::reference) == "reference" && name_of(QualityLevel::draft) == "draft");

}  // namespace matchlight
