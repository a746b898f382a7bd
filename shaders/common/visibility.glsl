// How much of the environment reaches a point of a surface past the other objects, and from where: 1 is all of it. What
// the scene does not need is compiled out, and then nothing blocks anything.
#ifndef MATCHLIGHT_VISIBILITY
#define MATCHLIGHT_VISIBILITY 0
#endif
#ifndef MATCHLIGHT_NEAR_SURFACE
#define MATCHLIGHT_NEAR_SURFACE 0
#endif

#if MATCHLIGHT_VISIBILITY
#include "effects/object_shadow/object_shadow.glsl"
#endif

vec3 diffuse_visibility(vec3 world_position, vec3 world_normal) {
#if MATCHLIGHT_VISIBILITY
    return object_shadow(world_position, world_normal);
#else
    return vec3(1.0);
#endif
}

vec3 specular_visibility(vec3 world_position, vec3 world_normal, vec3 reflected_direction, float roughness) {
#if MATCHLIGHT_VISIBILITY
    return vec3(light_left_on_surface(world_position, reflected_direction));
#else
    return vec3(1.0);
#endif
}

#if MATCHLIGHT_NEAR_SURFACE
uniform float near_surface_z_m;
uniform vec3 probe_place_m;   // above the surface
#endif

// The direction in which the probe shows what a ray from a point meets: a ray that goes down ends on the real surface,
// which is near, and the probe saw that spot from its own place (after Brennan 2002, "Accurate Environment Mapped
// Reflections and Refractions by Adjusting for Object Distance").
vec3 direction_in_probe(vec3 world_position, vec3 direction) {
#if MATCHLIGHT_NEAR_SURFACE
    float height_m = world_position.z - near_surface_z_m;
    if (direction.z < 0.0 && height_m > 0.0) {
        vec3 met = world_position + direction * (height_m / -direction.z);
        return normalize(met - probe_place_m);
    }
#endif
    return direction;
}
