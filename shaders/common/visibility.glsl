// What of the probe a ray from a surface meets, and how much of its light is left there.
#include "effects/contact_shadow/contact_shadow.glsl"

uniform float surface_z_m;
uniform int surface_shadow_present;   // whether the real surface lies in a contact shadow
uniform int surface_is_near;          // whether the probe's place over the surface is known
uniform vec3 probe_place_m;           // above the surface

// Where a ray that goes down from above the real surface ends on it.
bool meets_surface(vec3 world_position, vec3 direction, out vec3 met) {
    float height_m = world_position.z - surface_z_m;
    met = world_position;
    if (direction.z >= 0.0 || height_m < 0.0) return false;
    met = world_position + direction * (height_m / -direction.z);
    return true;
}

// The share of the surface's light that the contact shadow leaves where the ray ends; 1 for rays that go elsewhere.
float light_left_along(vec3 world_position, vec3 direction) {
    vec3 met;
    if (surface_shadow_present == 0 || !meets_surface(world_position, direction, met)) return 1.0;
    return contact_shadow_nearest(met.xy);
}

// The direction in which the probe shows what a ray from a point meets: the surface is near, and the probe saw that
// spot of it from its own place (after Brennan 2002, "Accurate Reflections and Refractions by Adjusting for Object
// Distance").
vec3 direction_in_probe(vec3 world_position, vec3 direction) {
    vec3 met;
    if (surface_is_near == 0 || !meets_surface(world_position, direction, met)) return direction;
    return normalize(met - probe_place_m);
}
