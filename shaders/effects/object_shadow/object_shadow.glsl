// The share of the light over a point's hemisphere that the objects themselves let through. Include
// common/environment.glsl before.
#include "common/visibility.glsl"

struct DirectionOfLight {
    vec4 to_light;   // w: the solid angle that it stands for
    vec4 light;      // radiance times that
    vec4 axis_u, axis_v;
};
#ifdef PAIRED_MAPS
// One of odd number is the opposite of the one before it, and both share a map.
const int directions_a_map = 2;
layout(std430, binding = 4) readonly buffer ObjectShadowLights { DirectionOfLight object_shadow_lights[]; };
#else
const int directions_a_map = 1;
layout(std140, binding = 0) uniform ObjectShadowLights { DirectionOfLight object_shadow_lights[256]; };
#endif
uniform int object_shadow_count;

// One layer a direction, around a sphere of casters; radius 0: nothing casts.
uniform sampler2DArray object_shadow_depth;
uniform vec3 object_shadow_centre_m;
uniform float object_shadow_radius_m;
uniform sampler2DArray real_shadow_depth;     // of real things
uniform vec3 real_shadow_centre_m;
uniform float real_shadow_radius_m;

// How far along a direction of light, which a point sees at an angle of this cosine, the last caster stands; 0: none does.
float way_to_caster_m(sampler2DArray depth, vec3 centre_m, float radius_m, vec3 world_position, vec3 world_normal, int i,
                      float cosine) {
    if (radius_m <= 0.0) return 0.0;
    ivec2 size = textureSize(depth, 0).xy;
    // In texels of the maps: off the surface along its normal, and towards the light where that grazes it.
    float texel_m = 2.0 * radius_m / float(size.x);
    vec3 lifted = (world_position + world_normal * (1.5 * texel_m) - centre_m) / radius_m;
    vec2 at = vec2(dot(lifted, object_shadow_lights[i].axis_u.xyz), dot(lifted, object_shadow_lights[i].axis_v.xyz)) * 0.5 + 0.5;
    if (at != clamp(at, 0.0, 1.0)) return 0.0;  // past all of them
    float height = dot(lifted, object_shadow_lights[i].to_light.xyz) * 0.5 + 0.5;
    float slope = sqrt(max(1.0 - cosine * cosine, 0.0)) / max(cosine, 0.1);
    float bias = (0.5 + slope) / float(size.x);
    ivec2 texel = min(ivec2(at * vec2(size)), size - 1);
#ifdef PAIRED_MAPS
    float highest = texelFetch(depth, ivec3(texel, i / directions_a_map), 0)[i % directions_a_map];
#else
    float highest = texelFetch(depth, ivec3(texel, i), 0).r;
#endif
    // 0 is no caster, and a point beyond all of them may lie lower.
    return highest > max(height + bias, 0.0) ? (highest - height) * 2.0 * radius_m : 0.0;
}

bool is_shaded_by_objects(vec3 world_position, vec3 world_normal, int i, float cosine) {
    return way_to_caster_m(object_shadow_depth, object_shadow_centre_m, object_shadow_radius_m, world_position, world_normal, i,
                           cosine) > 0.0;
}

float way_to_real_thing_m(vec3 world_position, vec3 world_normal, int i, float cosine) {
    return way_to_caster_m(real_shadow_depth, real_shadow_centre_m, real_shadow_radius_m, world_position, world_normal, i, cosine);
}

// What a real thing sends in the place of the light that it keeps away: what the probe saw of it from its own place. Sharp,
// or a lamp beside it would shine through.
vec3 radiance_of_real_thing(vec3 world_position, vec3 direction, float way_m) {
    const float sharp_roughness = 0.1;
    return reflected_radiance(direction_of_place(world_position + way_m * direction, direction), sharp_roughness);
}

// The direction of a map that a surface sees, and its cosine; 0 or less: it sees none.
int seen_direction(int first, vec3 world_normal, out float cosine) {
    cosine = dot(world_normal, object_shadow_lights[first].to_light.xyz);
#ifdef PAIRED_MAPS
    if (cosine < 0.0) {
        cosine = -cosine;
        return first + 1;
    }
#endif
    return first;
}

// Whether objects take any light of a point: of most of a real thing they do not, which is soon found.
bool is_in_shadow(vec3 world_position, vec3 world_normal) {
    for (int first = 0; first < object_shadow_count; first += directions_a_map) {
        float cosine;
        int i = seen_direction(first, world_normal, cosine);
        if (cosine <= 0.0) continue;
        vec3 to_light = object_shadow_lights[i].to_light.xyz;
        if (is_shaded_by_objects(world_position, world_normal, i, cosine) || light_left_along(world_position, to_light) < 1.0) return true;
    }
    return false;
}

// With the casters over without. Where real things stand before the light a virtual surface has theirs, and a real one,
// which the footage shows so, none to lose.
vec3 object_shadow(vec3 world_position, vec3 world_normal, bool is_real) {
    if (is_real && !is_in_shadow(world_position, world_normal)) return vec3(1.0);
    vec3 open = vec3(0.0);
    vec3 all = vec3(0.0);
    for (int first = 0; first < object_shadow_count; first += directions_a_map) {
        float cosine;
        int i = seen_direction(first, world_normal, cosine);
        if (cosine <= 0.0) continue;
        vec3 to_light = object_shadow_lights[i].to_light.xyz;
        // Of what hides the near surface, which parallel light stands for badly, bounced light knows better.
        vec3 met;
        bool from_surface = !is_real && meets_surface(world_position, to_light, met);
        float to_real_m = from_surface ? 0.0 : way_to_real_thing_m(world_position, world_normal, i, cosine);
        if (is_real && to_real_m > 0.0) continue;
        vec3 light = object_shadow_lights[i].light.rgb;
        all += light * cosine;
        if (is_shaded_by_objects(world_position, world_normal, i, cosine)) continue;
        if (to_real_m > 0.0)
            light = object_shadow_lights[i].to_light.w * radiance_of_real_thing(world_position, to_light, to_real_m);
        else
            light *= light_left_along(world_position, to_light);
        open += light * cosine;
    }
    return vec3(all.r > 0.0 ? open.r / all.r : 1.0, all.g > 0.0 ? open.g / all.g : 1.0, all.b > 0.0 ? open.b / all.b : 1.0);
}
