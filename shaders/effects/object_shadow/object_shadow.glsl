// The share of the light over a point's hemisphere that the objects themselves let through.
#include "common/visibility.glsl"

uniform sampler2DArray object_shadow_depth;   // one layer a direction
struct DirectionOfLight {
    vec4 to_light, light, axis_u, axis_v;   // xyz of each; light = radiance times solid angle
};
layout(std140, binding = 0) uniform ObjectShadowLights { DirectionOfLight object_shadow_lights[256]; };
uniform int object_shadow_count;
uniform vec3 object_shadow_centre_m;
uniform float object_shadow_radius_m;

vec3 object_shadow(vec3 world_position, vec3 world_normal) {
    ivec2 size = textureSize(object_shadow_depth, 0).xy;
    // In texels of the maps: off the surface along its normal, and towards the light where that grazes it.
    float texel_m = 2.0 * object_shadow_radius_m / float(size.x);
    vec3 lifted = (world_position + world_normal * (1.5 * texel_m) - object_shadow_centre_m) / object_shadow_radius_m;
    vec3 open = vec3(0.0);
    vec3 all = vec3(0.0);
    for (int i = 0; i < object_shadow_count; ++i) {
        vec3 to_light = object_shadow_lights[i].to_light.xyz;
        float cosine = dot(world_normal, to_light);
        if (cosine <= 0.0) continue;
        vec3 light = object_shadow_lights[i].light.rgb * cosine;
        all += light;
        vec3 axis_u = object_shadow_lights[i].axis_u.xyz;
        vec3 axis_v = object_shadow_lights[i].axis_v.xyz;
        vec2 at = vec2(dot(lifted, axis_u), dot(lifted, axis_v)) * 0.5 + 0.5;
        float height = dot(lifted, to_light) * 0.5 + 0.5;
        float slope = sqrt(max(1.0 - cosine * cosine, 0.0)) / max(cosine, 0.1);
        float bias = (0.5 + slope) / float(size.x);
        float highest = texelFetch(object_shadow_depth, ivec3(clamp(ivec2(at * vec2(size)), ivec2(0), size - 1), i), 0).r;
        if (highest > height + bias) continue;
        open += light * light_left_along(world_position, to_light);
    }
    return vec3(all.r > 0.0 ? open.r / all.r : 1.0, all.g > 0.0 ? open.g / all.g : 1.0, all.b > 0.0 ? open.b / all.b : 1.0);
}
