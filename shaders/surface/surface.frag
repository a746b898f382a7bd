#version 450 core
// Scene-linear radiance that a surface sends to the eye under the environment, premultiplied with its coverage.
#include "common/environment.glsl"
#include "common/material.glsl"
#include "common/visibility.glsl"
#ifdef LENS
#include "surface/lens_focus.glsl"
#endif

in vec3 world_position;
in vec3 world_normal;
in vec4 world_tangent;
in vec2 material_uv;
in vec4 vertex_color;
in vec3 vertex_visibility;  // of the light over the hemisphere, past other objects

uniform vec3 eye_world;
uniform bool reflects_sphere_map = false;
uniform bool is_classic = false;
uniform vec3 classic_diffuse = vec3(0.0);   // Od
uniform vec3 classic_specular = vec3(0.0);  // Ks

layout(location = 0) out vec4 color;
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

// Standard deviation of the reflected directions of a GGX lobe's core, in units of alpha.
const float lobe_width = 1.09;

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

// What comes along a reflected direction; with a lens, as far as the picture is not to be blurred for it.
vec3 mirrored_radiance(vec3 direction, float roughness) {
#ifdef LENS
    // As many points as the disc has pixels; more than a few dozen are not told apart. A single point is in the loop, too:
    // of two ways some drivers go both.
    bool is_spread = reflection_left_px >= least_left_px && !is_blurred_by(lobe_width * roughness * roughness);
    int count = is_spread ? clamp(int(reflection_left_px * reflection_left_px), 8, 64) : 1;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < count; ++i) {
        vec3 turned = count == 1 ? direction : normalize(direction + turn_through_lens(i, count));
        sum += reflected_radiance(direction_in_probe(world_position, turned), roughness);
    }
    return sum / float(count);
#else
    return reflected_radiance(direction_in_probe(world_position, direction), roughness);
#endif
}

// Light that a GGX surface reflects at its first meeting with it, and after several.
struct Scattering {
    vec3 single, multiple;
};

// Fdez-Agüera 2019, "A Multiple-Scattering Microfacet Model for Real-Time Image-based Lighting": what the split sum
// misses comes back as if diffuse, so that a white surface in white light sends back all of it.
Scattering scattering(vec3 f0, vec2 table) {
    vec3 single = f0 * table.x + table.y;
    float missing = 1.0 - (table.x + table.y);
    vec3 mean_fresnel = f0 + (1.0 - f0) / 21.0;
    return Scattering(single, missing * single * mean_fresnel / (1.0 - mean_fresnel * missing));
}

void main() {
    vec4 base = base_color_at(material_uv, vertex_color);
    if (base.a < alpha_cutoff) discard;
    float alpha = alpha_blends ? clamp(base.a, 0.0, 1.0) : 1.0;

    vec3 n = shading_normal(world_normal, world_tangent, material_uv, gl_FrontFacing);
    vec3 v = normalize(eye_world - world_position);
    // An interpolated normal may turn away from the eye near a silhouette; seen edge on it still reflects forwards.
    const float least_cosine = 1e-4;
    float n_dot_v = dot(n, v);
    if (n_dot_v < least_cosine) {
        n = normalize(n + (least_cosine - n_dot_v) * v);
        n_dot_v = least_cosine;
    }
    vec3 reflected = reflect(-v, n);
    vec3 reflected_dx = dFdx(reflected), reflected_dy = dFdy(reflected);
#ifdef LENS
    focus_reflection(n, v, length(eye_world - world_position), reflected_dx, reflected_dy);
#endif
    vec3 diffuse_light = diffuse_radiance(n) * vertex_visibility;

    vec3 radiance, reflection;
    float reflection_roughness = 0.0;
    if (reflects_sphere_map || is_classic) {
        vec3 seen = direction_in_probe(world_position, reflected);
        vec3 environment = reflects_sphere_map
                               ? texture(environment_sphere_map, sphere_map_uv(seen)).rgb
                               : mirrored_radiance(reflected, widened_roughness(0.0, reflected_dx, reflected_dy));
        reflection = classic_specular * environment * light_left_along(world_position, reflected);
        radiance = classic_diffuse * diffuse_light + reflection;
    } else {
        vec2 metallic_roughness = metallic_roughness_at(material_uv);
        float metallic = metallic_roughness.x;
        float roughness = metallic_roughness.y;
        float occlusion = occlusion_at(material_uv);
        vec2 table = split_sum(n_dot_v, roughness);
        // A mixture of two materials, so that each keeps its own energy: glTF 2.0, appendix B.
        Scattering dielectric = scattering(vec3(0.04), table);
        Scattering metal = scattering(base.rgb, table);
        vec3 single = mix(dielectric.single, metal.single, metallic);
        vec3 multiple = mix(dielectric.multiple, metal.multiple, metallic);
        vec3 transmitted = (1.0 - metallic) * base.rgb * (1.0 - dielectric.single - dielectric.multiple);

        // The lobe of a rough surface leans towards the normal.
        vec3 dominant = normalize(mix(reflected, n, pow(roughness, 4.0)));
        vec3 glossy = mirrored_radiance(dominant, widened_roughness(roughness, reflected_dx, reflected_dy)) *
                      light_left_along(world_position, dominant) *
                      specular_occlusion(n_dot_v, occlusion, roughness);
        reflection = single * glossy;
        reflection_roughness = roughness;
        radiance = reflection + (multiple + transmitted) * diffuse_light * occlusion;
    }
    radiance += emissive_at(material_uv);
#ifdef LENS
    float share = dot(reflection, vec3(1.0)) / max(dot(radiance, vec3(1.0)), 1e-20);
    float lobe = lobe_width * reflection_roughness * reflection_roughness;
    focus_share = vec4(alpha * focus_share_of(seen_coc_px(share, lobe)), 0.0, 0.0, alpha);
#endif
#ifdef COVERAGE
    coverage = vec4(alpha);
#endif
    color = vec4(min(radiance, vec3(largest_half)) * alpha, alpha);
}
