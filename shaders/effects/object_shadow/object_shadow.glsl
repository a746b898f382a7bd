// The share of the light over a point's hemisphere that the objects themselves let through.
#include "effects/contact_shadow/contact_shadow.glsl"

uniform sampler2DArray object_shadow_depth;   // one layer a direction
uniform sampler2D object_shadow_lights;       // rows: towards the light, light, axis u, axis v
uniform vec3 object_shadow_centre_m;
uniform float object_shadow_radius_m;
uniform int surface_shadow_present;           // whether light from the surface is dimmed where it left
uniform float real_surface_z_m;

// Where a ray from a point meets the real surface, and how much of the surface's light is left there. The coarse map
// alone serves: one direction of many.
float light_left_on_surface(vec3 world_position, vec3 direction) {
    if (surface_shadow_present == 0 || direction.z >= 0.0) return 1.0;
    float distance_m = max((real_surface_z_m - world_position.z) / direction.z, 0.0);
    vec2 at = world_position.xy + direction.xy * distance_m;
    return dot(contact_shadow(at), vec3(1.0 / 3.0));
}

vec3 object_shadow(vec3 world_position, vec3 world_normal) {
    ivec2 size = textureSize(object_shadow_depth, 0).xy;
    int count = textureSize(object_shadow_lights, 0).x;
    // In texels of the maps: off the surface along its normal, and towards the light where that grazes it.
    float texel_m = 2.0 * object_shadow_radius_m / float(size.x);
    vec3 lifted = (world_position + world_normal * (1.5 * texel_m) - object_shadow_centre_m) / object_shadow_radius_m;
    vec3 open = vec3(0.0);
    vec3 all = vec3(0.0);
    for (int i = 0; i < count; ++i) {
        vec3 to_light = texelFetch(object_shadow_lights, ivec2(i, 0), 0).xyz;
        float cosine = dot(world_normal, to_light);
        if (cosine <= 0.0) continue;
        vec3 light = texelFetch(object_shadow_lights, ivec2(i, 1), 0).rgb * cosine;
        all += light;
        vec3 axis_u = texelFetch(object_shadow_lights, ivec2(i, 2), 0).xyz;
        vec3 axis_v = texelFetch(object_shadow_lights, ivec2(i, 3), 0).xyz;
        vec2 at = vec2(dot(lifted, axis_u), dot(lifted, axis_v)) * 0.5 + 0.5;
        float height = dot(lifted, to_light) * 0.5 + 0.5;
        float slope = sqrt(max(1.0 - cosine * cosine, 0.0)) / max(cosine, 0.1);
        float bias = (0.5 + slope) / float(size.x);
        float highest = texelFetch(object_shadow_depth, ivec3(clamp(ivec2(at * vec2(size)), ivec2(0), size - 1), i), 0).r;
        if (highest > height + bias) continue;
        open += light * light_left_on_surface(world_position, to_light);
    }
    return vec3(all.r > 0.0 ? open.r / all.r : 1.0, all.g > 0.0 ? open.g / all.g : 1.0, all.b > 0.0 ? open.b / all.b : 1.0);
}
