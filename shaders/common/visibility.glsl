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

// The direction in which the probe shows a place that a ray of `direction` meets: it saw that from its own place, where
// that is known (after Brennan 2002, "Accurate Reflections and Refractions by Adjusting for Object Distance").
vec3 direction_of_place(vec3 met, vec3 direction) {
    vec3 from_probe = met - probe_place_m;
    return surface_is_near != 0 && dot(from_probe, from_probe) > 0.0 ? normalize(from_probe) : direction;
}

// The direction in which it shows what a ray from a point meets: the surface, or what is far.
vec3 direction_in_probe(vec3 world_position, vec3 direction) {
    vec3 met;
    return meets_surface(world_position, direction, met) ? direction_of_place(met, direction) : direction;
}

// The roughness whose lobe shows from the probe's place as much of a place as a ray's lobe does from where the ray begins:
// a lobe's width goes with the square.
float roughness_from_probe(float roughness, float way_m, vec3 met) {
    return surface_is_near != 0 ? min(roughness * sqrt(way_m / max(length(met - probe_place_m), 1e-9)), 1.0) : roughness;
}
