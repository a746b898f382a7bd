#version 450 core
// The shadow on the real surface, along the way of the surface before the camera.

#include "common/graph.glsl"
#include "common/lens_map.glsl"
#include "effects/motion_blur/way.glsl"
#include "effects/motion_blur/walk.glsl"

uniform sampler2D ratio;  // share of the surface's light, a = 1
uniform ivec4 ratio_region;
uniform mat3 world_from_camera;
uniform vec3 eye_world_m;
uniform float surface_z_m;
uniform mat4 opening_camera_from_world, closing_camera_from_world;
uniform float longest_way_px;
uniform float least_visible_loss;  // a shadow that changes less than this share of the light is none

layout(location = 0) out vec4 blurred;

vec4 ratio_at(ivec2 pixel) {
    ivec2 last = ratio_region.xy + ratio_region.zw - 1;
    return texelFetch(ratio, clamp(pixel, ratio_region.xy, last) - ratio_region.xy, 0);
}

vec2 way_of_surface(vec2 pixel) {
    vec2 normalized = normalized_from_pixel(pixel);
    if (any(isnan(normalized))) return vec2(0.0);
    vec3 direction = world_from_camera * vec3(normalized, 1.0);
    float distance_m = (surface_z_m - eye_world_m.z) / direction.z;
    if (!(distance_m > 0.0) || isinf(distance_m)) return vec2(0.0);
    vec4 point = vec4(eye_world_m + direction * distance_m, 1.0);
    vec3 opening = (opening_camera_from_world * point).xyz, closing = (closing_camera_from_world * point).xyz;
    if (opening.z <= 0.0 || closing.z <= 0.0) return vec2(0.0);
    vec2 way = way_of_change(closing.xy / closing.z - opening.xy / opening.z, pixel, normalized);
    float length_px = length(way);
    return length_px > longest_way_px ? way * (longest_way_px / length_px) : way;
}

void main() {
    ivec2 pixel = target_texel();
    blurred = ratio_at(pixel);
    vec2 way = way_of_surface(vec2(pixel));
    if (way == vec2(0.0)) return;
    Walk walk = walk_along(way);
    float smear = length(way);
    vec3 sum = vec3(0.0);
    for (int i = -walk.taps; i <= walk.taps; ++i) {
        float weight = smear_at(float(i) * walk.spacing, walk.spacing, smear);
        if (weight == 0.0) continue;
        Tap tap = tap_at(pixel, walk, i);
        sum += weight * mix(ratio_at(tap.first).rgb, ratio_at(tap.second).rgb, tap.second_share);
    }
    // Even light stays the plate's, whatever rounding the sum has.
    blurred.rgb = all(lessThan(abs(sum - 1.0), vec3(max(least_visible_loss, 1e-6)))) ? vec3(1.0) : sum;
}
