#version 450 core
// Scene-linear radiance that a surface sends to the eye under the environment, premultiplied with its coverage.
#include "common/environment.glsl"
#include "common/material.glsl"
#include "common/material_layers.glsl"
#include "common/visibility.glsl"
#include "common/near_light.glsl"
#include "common/scattering.glsl"
#include "surface/seen.glsl"
#include "common/directions.glsl"
#ifdef TRANSMISSION
#include "surface/transmission.glsl"
#endif
#ifdef PATTERN
#include "surface/patterns.glsl"
#endif
#ifdef PICTURE_LAYERS
#include "surface/picture_layers.glsl"
#endif
#ifdef RAYS
#include "common/object_light.glsl"
#include "surface/lobe.glsl"
#endif
#ifdef LENS
#include "surface/lens_focus.glsl"
#endif
#ifdef LAMPS
#include "common/lamp_shadow.glsl"
#include "surface/lamp_light.glsl"
#endif
#ifdef CLASSIC_SHADING
#include "surface/classic.glsl"
#endif
#ifdef DEPTH_CUE
#include "surface/depth_cue.glsl"
#endif

#ifdef SPHERES
#include "effects/object_shadow/object_shadow.glsl"
#ifdef HALOS
#include "spheres/halo.glsl"
#endif
uniform bool objects_shade;
#else
in vec3 vertex_visibility;  // of the light over the hemisphere, past other objects
#endif
#ifdef RAYS
#ifdef SPHERES
const vec3 vertex_bounce = vec3(0.0);
#else
in vec3 vertex_bounce;      // irradiance over π that comes from other objects
#endif
uniform int lobe_rays;      // a fragment, along the lobe of a rough surface
vec3 seen_side;             // the triangle's normal towards the eye
#endif

#ifndef RELIEF
uniform vec3 eye_world;
#endif
uniform bool reflects_sphere_map = false;
uniform bool is_classic = false;
uniform vec3 classic_diffuse = vec3(0.0);   // Od
uniform vec3 classic_specular = vec3(0.0);  // Ks

layout(location = 0) out vec4 color;
#ifdef BLENDED
#include "spheres/blended.glsl"
#endif
#ifdef LISTED
#include "surface/listed.glsl"
#endif
#ifdef LENS
layout(location = 1) out vec4 focus_share;  // r: near_m / z that has the circle of confusion of what is seen, times a
#endif
#ifdef COVERAGE
layout(location = COVERAGE) out vec4 coverage;  // of virtual things; a = of real ones, too
#endif

// Over 65504 a half float is infinite, and one infinity floods every blur after it.
const float largest_half = 65504.0;

// Ambient occlusion of reflections (Lagarde & de Rousiers 2014, "Moving Frostbite to Physically Based Rendering").
float specular_occlusion(float n_dot_v, float occlusion, float roughness) {
    return clamp(pow(n_dot_v + occlusion, exp2(-16.0 * roughness - 1.0)) - 1.0 + occlusion, 0.0, 1.0);
}

// Roughness widened by what one pixel covers of the reflected directions, so that small lights on curved mirrors are
// averaged, not missed or hit by chance (after Tokuyoshi & Kaplanyan 2019, "Improved Geometric Specular Antialiasing",
// with the spread of the reflection in place of the half vector's). A pixel that spans an angle f has the variance f²/12;
// a GGX lobe's core, twice as wide about the reflection as about the half vector, has (1.09 alpha)². A fifth of that is
// taken: the lobe's tails and the filtering of the levels blur besides, and against 36 times the pixels a fifth leaves the
// least error on mirrors and glossy surfaces alike.
float widened_roughness(float roughness, vec3 reflected_dx, vec3 reflected_dy) {
    float span2 = min(0.5 * (dot(reflected_dx, reflected_dx) + dot(reflected_dy, reflected_dy)), 1.0);
    float alpha2 = pow(roughness, 4.0) + 0.2 * span2 / (12.0 * lobe_width * lobe_width);
    return min(sqrt(sqrt(alpha2)), 1.0);
}

// What comes along a direction, and how much of it the objects leave.
vec3 light_from(vec3 direction, float roughness) {
#ifdef RAYS
    return light_along(point_off(world_position, seen_side), direction_off(direction, seen_side), roughness, true);
#elif defined(PLANE)
    return light_beyond_objects(world_position, direction, roughness);
#else
    return reflected_radiance(direction_in_probe(world_position, direction), roughness) *
           light_left_along(world_position, direction);
#endif
}

// What comes along a reflected direction; with a lens, as far as the picture is not to be blurred for it.
vec3 mirrored_radiance(vec3 direction, float roughness) {
#ifdef LENS
    // As many points as the disc has pixels; more than a few dozen are not told apart. A single point is in the loop, too:
    // of two ways some drivers go both.
    bool is_spread = reflection_left_px >= least_left_px && !is_blurred_by(lobe_width * roughness * roughness);
#ifdef RAYS
    const int most_points = 16;  // rays cost more than looks into the probe
#else
    const int most_points = 64;
#endif
    int count = is_spread ? clamp(int(reflection_left_px * reflection_left_px), 8, most_points) : 1;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < count; ++i) {
        vec3 turned = count == 1 ? direction : normalize(direction + turn_through_lens(i, count));
        sum += light_from(turned, roughness);
    }
    return sum / float(count);
#else
    return light_from(direction, roughness);
#endif
}

#ifdef RAYS
#include "surface/lobe_light.glsl"

// Whether a lobe is wide against what the directions of neighbouring fragments span.
bool is_wide_lobe(float roughness, vec3 reflected_dx, vec3 reflected_dy) {
    float span2 = 0.5 * (dot(reflected_dx, reflected_dx) + dot(reflected_dy, reflected_dy));
    return lobe_rays > 1 && lobe_width * lobe_width * pow(roughness, 4.0) > span2 / 12.0;
}
#endif

// What a rough surface shows in the place of its mirror image.
vec3 glossy_radiance(vec3 n, vec3 v, vec3 reflected, float roughness, vec3 reflected_dx, vec3 reflected_dy) {
#if defined(RAYS)
#if defined(LENS)
    bool is_spread = reflection_left_px >= least_left_px && !is_blurred_by(lobe_width * roughness * roughness);
#else
    const bool is_spread = false;
#endif
    if (!is_spread && is_wide_lobe(roughness, reflected_dx, reflected_dy))
        return lobe_radiance(n, v, roughness, reflected_dx, reflected_dy);
#endif
    // The lobe of a rough surface leans towards the normal.
    vec3 dominant = normalize(mix(reflected, n, pow(roughness, 4.0)));
    return mirrored_radiance(dominant, widened_roughness(roughness, reflected_dx, reflected_dy));
}

#ifdef ANISOTROPY
// Smith's masking of a direction by a surface that is rougher one way (Heitz 2014, "Understanding the Masking-Shadowing
// Function in Microfacet-Based BRDFs").
float stretched_lambda(vec3 direction, vec3 n, vec3 along, vec2 alpha) {
    vec2 spread = alpha * vec2(dot(direction, along), dot(direction, cross(n, along)));
    float cosine = max(dot(direction, n), 1e-6);
    return 0.5 * (sqrt(1.0 + dot(spread, spread) / (cosine * cosine)) - 1.0);
}

// What a lobe shows that is wider one way: the slopes of a GGX surface along that way at even shares of its distribution,
// D(p, q) ~ (1 + p²/a² + q²/b²)^-2, whose marginal is ~ (1 + p²/a²)^-3/2. Across it each shows the probe's prefiltered lobe
// of that width, or of the gap to the next one where that is wider.
vec3 stretched_radiance(vec3 n, vec3 v, float roughness, Anisotropy stretch) {
    vec2 alpha = vec2(stretch.alpha, max(roughness * roughness, 1e-3));
#ifdef RAYS
    const int most = 12;
#else
    const int most = 32;
#endif
    int count = clamp(int(2.0 * alpha.x / alpha.y), 4, most);
    float eye_lambda = stretched_lambda(v, n, stretch.along, alpha);
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (int i = 0; i < count; ++i) {
        float share = (2.0 * float(i) + 1.0) / float(count) - 1.0;
        float rest = 1.0 - share * share;
        vec3 h = normalize(n + (alpha.x * share * inversesqrt(rest)) * stretch.along);
        vec3 direction = reflect(-v, h);
        float n_dot_h = dot(n, h), v_dot_h = dot(v, h);
        if (dot(n, direction) <= 0.0 || v_dot_h <= 0.0) continue;
        // Across, the slopes are wider where those along are steep. A gap, twice as wide about the reflection, has the
        // variance of a twelfth of its square.
        float across = alpha.y * inversesqrt(rest) * n_dot_h;
        float gap = 2.0 / float(count) * alpha.x * pow(rest, -1.5) * n_dot_h * n_dot_h;
        float width2 = max(across * across, gap * gap / (3.0 * lobe_width * lobe_width));
        float weight = v_dot_h / n_dot_h / (1.0 + eye_lambda + stretched_lambda(direction, n, stretch.along, alpha));
        sum += weight * light_from(direction, min(sqrt(sqrt(width2)), 1.0));
        weights += weight;
    }
    return weights > 0.0 ? sum / weights : light_from(reflect(-v, n), roughness);
}
#endif

#ifdef SHEEN
// What fibres show: a few wide looks over the hemisphere, weighted by what they send on.
vec3 sheen_radiance(vec3 n, vec3 v, float roughness) {
    const int count = 12;
    const float look_roughness = 0.75;  // twelve of them cover the hemisphere
    mat3 world_from_surface = frame_about(n);
    vec3 eye = v * world_from_surface;
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (int i = 0; i < count; ++i) {
        vec3 light = cosine_direction(i, count);
        float weight = sheen_distribution(eye, light, roughness);
        sum += weight * light_from(world_from_surface * light, look_roughness);
        weights += weight;
    }
    return sum / max(weights, 1e-20);
}
#endif

void main() {
    if (!see()) discard;
#ifdef SPHERES
    vec3 vertex_visibility = objects_shade ? object_shadow(world_position, world_normal, false) : vec3(1.0);
#endif
    vec4 base = base_color_at(material_uv, vertex_color);
    if (base.a < alpha_cutoff) discard;
#ifdef PATTERN
#ifdef RELIEF
    base.rgb *= pattern_at(material_uv, relief_uv_dx, relief_uv_dy);
#else
    base.rgb *= pattern_at(material_uv, dFdx(material_uv), dFdy(material_uv));
#endif
#endif
#ifdef PICTURE_LAYERS
    base.rgb = with_picture_layers(base.rgb, material_uv);
#endif
    float alpha = alpha_blends ? clamp(base.a, 0.0, 1.0) : 1.0;
#ifdef LISTED
    if (counts_only) {
        list(vec4(0.0));
        return;
    }
#endif
#ifdef GATHER_MOMENTS
    color = blended(vec3(0.0), alpha);
    return;
#endif

#ifdef UNLIT
#ifdef DEPTH_CUE
    base.rgb = with_depth_cue(base.rgb, 1.0 / inverse_z());
#endif
    color = vec4(min(max(base.rgb, vec3(0.0)), vec3(largest_half)) * alpha, alpha);
#ifdef COVERAGE
    coverage = vec4(alpha);
#endif
#ifdef LENS
    focus_share = vec4(alpha * focus_share_of(surface_coc_px()), 0.0, 0.0, alpha);
#endif
#else
    float slope_variance;
    vec3 n = shading_normal(world_normal, world_tangent, material_uv, front_facing, slope_variance);
    vec3 v = normalize(eye_world - world_position);
    // An interpolated normal may turn away from the eye near a silhouette; seen edge on it still reflects forwards.
    const float least_cosine = 1e-4;
    float n_dot_v = dot(n, v);
    if (n_dot_v < least_cosine) {
        n = normalize(n + (least_cosine - n_dot_v) * v);
        n_dot_v = least_cosine;
    }
    vec3 reflected = reflect(-v, n);
#ifdef SPHERES
    vec3 reflected_dx, reflected_dy;
    reflected_steps(reflected, reflected_dx, reflected_dy);
#else
    vec3 reflected_dx = dFdx(reflected), reflected_dy = dFdy(reflected);
#endif
#ifdef LENS
    focus_reflection(n, v, length(eye_world - world_position), reflected_dx, reflected_dy);
#endif
    vec3 diffuse_light = diffuse_radiance(n) * vertex_visibility;
#ifdef RAYS
    // Between vertices, what near things send instead of far ones may take more than the map of directions left here.
    diffuse_light = max(diffuse_light + vertex_bounce, vec3(0.0));
#ifdef SPHERES
    seen_side = world_normal;
#else
    seen_side = cross(dFdx(world_position), dFdy(world_position));
    seen_side = dot(seen_side, seen_side) > 0.0 ? normalize(seen_side) : n;
    if (dot(seen_side, v) < 0.0) seen_side = -seen_side;
#endif
#endif

    vec3 radiance, reflection;
    float reflection_roughness = 0.0;
#ifdef LAMPS
    LampSurface lit;
    lit.v = v;
    lit.pixel_span2 = pixel_span2(reflected_dx, reflected_dy);
#endif
    if (reflects_sphere_map || is_classic) {
        vec3 seen = direction_in_probe(world_position, reflected);
        vec3 environment = reflects_sphere_map
                               ? texture(environment_sphere_map, sphere_map_uv(seen)).rgb *
                                     light_left_along(world_position, reflected)
                               : mirrored_radiance(reflected, widened_roughness(0.0, reflected_dx, reflected_dy));
        reflection = classic_specular * environment;
        radiance = classic_diffuse * diffuse_light + reflection;
#ifdef LAMPS
        lit.lobe = LampLobe(n, vec2(0.0), vec3(0.0));
        lit.diffuse = classic_diffuse;
        // Ks is all that it mirrors, at every angle.
        lit.f0_dielectric = classic_specular;
        lit.f90_dielectric = classic_specular;
        lit.metallic = 0.0;
        lit.f0_metal = vec3(0.0);
#endif
    } else {
        vec2 metallic_roughness = metallic_roughness_at(material_uv);
        float metallic = metallic_roughness.x;
        float roughness = roughness_with(metallic_roughness.y, slope_variance);
        float occlusion = occlusion_at(material_uv);
#ifdef ANISOTROPY
        Anisotropy stretch = anisotropy_at(material_uv, n, world_tangent, front_facing, roughness);
        // As much as a round lobe of the same mean variance sends back: within 0.02 (tests/gpu/material_layers_test.cpp).
        vec2 table = split_sum(n_dot_v, sqrt(sqrt(0.5 * (pow(roughness, 4.0) + stretch.alpha * stretch.alpha))));
#else
        vec2 table = split_sum(n_dot_v, roughness);
#endif
#ifdef SPECULAR
        MaterialScattering sent = material_scattering(base.rgb, metallic, table, specular_at(material_uv));
#else
        MaterialScattering sent = material_scattering(base.rgb, metallic, table);
#endif
        vec3 shown = glossy_radiance(n, v, reflected, roughness, reflected_dx, reflected_dy);
#ifdef ANISOTROPY
        if (stretch.along != vec3(0.0)) shown = stretched_radiance(n, v, roughness, stretch);
#endif
        reflection = sent.mirrored * shown * specular_occlusion(n_dot_v, occlusion, roughness);
        reflection_roughness = roughness;
#ifdef TRANSMISSION
        vec3 through = sent.entered * transmission_at(material_uv);
        radiance = reflection + (sent.diffuse - through) * diffuse_light * occlusion +
                   through * light_through(n, v, roughness, thickness_at(material_uv));
#else
        radiance = reflection + sent.diffuse * diffuse_light * occlusion;
#endif
#ifdef SHEEN
        vec3 sheen_color = sheen_color_at(material_uv);
        float sheen_roughness = sheen_roughness_at(material_uv);
        float fibres = sheen_albedo(n_dot_v, sheen_roughness);
        // What is below loses what the fibres send back.
        float below = 1.0 - max(sheen_color.r, max(sheen_color.g, sheen_color.b)) * fibres;
        reflection *= below;
        radiance = below * radiance + sheen_color * fibres * occlusion * sheen_radiance(n, v, sheen_roughness);
#endif
#ifdef LAMPS
        lit.lobe = LampLobe(n, vec2(pow(roughness, 4.0)), vec3(0.0));
        lit.diffuse = sent.diffuse;
#ifdef TRANSMISSION
        lit.diffuse -= through;
#endif
#ifdef ANISOTROPY
        lit.lobe.alpha2.x = stretch.alpha * stretch.alpha;
        lit.lobe.stretched = stretch.along;
#endif
#ifdef SPECULAR
        vec4 specular = specular_at(material_uv);
        lit.f0_dielectric = specular.rgb;
        lit.f90_dielectric = vec3(specular.a);
#else
        lit.f0_dielectric = dielectric_f0;
        lit.f90_dielectric = vec3(1.0);
#endif
        lit.f0_metal = base.rgb;
        lit.metallic = metallic;
#ifdef SHEEN
        lit.sheen_color = sheen_color;
        lit.sheen_roughness = sheen_roughness;
        lit.below_sheen = below;
#endif
#endif
    }
    radiance += emissive_at(material_uv);
#ifdef COAT
    // Over all the rest, its glow included.
    float coat_slope_variance;
    vec3 coat_n = coat_normal(world_normal, world_tangent, material_uv, front_facing, coat_slope_variance);
    float coat_cosine = dot(coat_n, v);
    if (coat_cosine < least_cosine) {
        coat_n = normalize(coat_n + (least_cosine - coat_cosine) * v);
        coat_cosine = least_cosine;
    }
    float coat_roughness = roughness_with(coat_roughness_at(material_uv), coat_slope_variance);
    Scattering coat = scattering(dielectric_f0, split_sum(coat_cosine, coat_roughness));
    float coated = coat_strength_at(material_uv) * coat.single.r;
    vec3 coat_reflected = reflect(-v, coat_n);
    vec3 coat_reflection = coated * glossy_radiance(coat_n, v, coat_reflected, coat_roughness, dFdx(coat_reflected),
                                                    dFdy(coat_reflected));
    if (dot(coat_reflection, vec3(1.0)) > dot(reflection, vec3(1.0))) reflection_roughness = coat_roughness;
    reflection = (1.0 - coated) * reflection + coat_reflection;
    radiance = (1.0 - coated) * radiance + coat_reflection;
#ifdef LAMPS
    lit.coat = LampLobe(coat_n, vec2(pow(coat_roughness, 4.0)), vec3(0.0));
    lit.coat_pixel_span2 = pixel_span2(dFdx(coat_reflected), dFdy(coat_reflected));
    lit.coat_strength = coat_strength_at(material_uv);
    lit.below_coat = 1.0 - coated;
#endif
#endif
#ifdef LAMPS
#ifdef RELIEF
    unmapped_normal = front_facing ? relief_flat_normal : -relief_flat_normal;
#else
    unmapped_normal = n;
    if ((material_textures & has_normal) != 0) unmapped_normal = normalize(front_facing ? world_normal : -world_normal);
#endif
#ifdef RAYS
    vec3 lamp_side = seen_side;
#else
    vec3 lamp_side = unmapped_normal;
#endif
#ifdef CLASSIC_SHADING
    if (shading_model != 0) {
        float metal = metallic_roughness_at(material_uv).x;
        ClassicSurface drawn = ClassicSurface(n, v, (1.0 - metal) * base.rgb, mix(dielectric_f0, base.rgb, metal), vertex_visibility);
        if (is_classic) {
            drawn.diffuse = classic_diffuse;
            drawn.specular = classic_specular;
        }
        reflection = vec3(0.0);
        radiance = classic_radiance(drawn, world_position, lamp_side) + emissive_at(material_uv);
    } else
#endif
    radiance += lamp_radiance(lit, world_position, lamp_side);
#endif
#ifdef DEPTH_CUE
    radiance = with_depth_cue(radiance, 1.0 / inverse_z());
#endif
#ifdef LENS
    float share = dot(reflection, vec3(1.0)) / max(dot(radiance, vec3(1.0)), 1e-20);
    float lobe = lobe_width * reflection_roughness * reflection_roughness;
    focus_share = vec4(alpha * focus_share_of(seen_coc_px(share, lobe)), 0.0, 0.0, alpha);
#endif
#ifdef COVERAGE
    coverage = vec4(alpha);
#endif
#ifdef BLENDED
    color = blended(min(radiance, vec3(largest_half)), alpha);
#else
    color = vec4(min(radiance, vec3(largest_half)) * alpha, alpha);
#endif
#endif
#if defined(SPHERES) && defined(HALOS)
    color.rgb *= light_past_halos();
#endif
#ifdef LISTED
    list(color);
#endif
}
