// The shadow on the real surface, by plate direction. Include effects/contact_shadow/contact_shadow.glsl before.

uniform float surface_z_m;
uniform int shadow_present;
uniform float least_visible_loss;    // a shadow that changes less than this share of the light is none
uniform mat3 world_from_camera;
uniform vec3 eye_world_m;

// Along the camera's z; 0 where the surface lies behind the camera or along the view: no such point is seen.
float surface_distance_m(vec2 normalized) {
    vec3 direction = world_from_camera * vec3(normalized, 1.0);
    float distance_m = (surface_z_m - eye_world_m.z) / direction.z;
    return distance_m > 0.0 && !isinf(distance_m) ? distance_m : 0.0;
}

vec3 shadow_over_pixel(vec2 normalized) {
    vec3 direction = world_from_camera * vec3(normalized, 1.0);
    float distance_m = surface_distance_m(normalized);
    if (distance_m == 0.0) return vec3(1.0);
    return contact_shadow(eye_world_m.xy + direction.xy * distance_m);
}

vec3 visible_shadow(vec2 normalized) {
    vec3 ratio = shadow_over_pixel(normalized);
    return all(lessThan(abs(ratio - 1.0), vec3(least_visible_loss))) ? vec3(1.0) : ratio;
}
