// How much of the environment reaches a point of a surface past the other objects: 1 is all of it. Without
// MATCHLIGHT_VISIBILITY nothing blocks anything.
#ifndef MATCHLIGHT_VISIBILITY
#define MATCHLIGHT_VISIBILITY 0
#endif

#if MATCHLIGHT_VISIBILITY == 0
vec3 diffuse_visibility(vec3 world_position, vec3 world_normal) {
    return vec3(1.0);
}

vec3 specular_visibility(vec3 world_position, vec3 world_normal, vec3 reflected_direction, float roughness) {
    return vec3(1.0);
}
#endif
