#version 450 core
// What the real surface mirrors of the virtual objects, and what it mirrored without them, on plate pixels.

#include "common/graph.glsl"
#include "common/lens_map.glsl"
#include "common/environment.glsl"
#include "common/visibility.glsl"
#include "common/near_light.glsl"
#include "common/object_light.glsl"
#include "surface/lobe.glsl"

uniform mat3 world_from_camera;
uniform vec3 eye_world_m;
uniform float mirror_z_m;
uniform float reflectance;          // of light that falls straight on; 0: none at all
uniform float roughness;
uniform float widest_tangent;       // of half vectors, over alpha: those beyond are left out
uniform float lobe_reach;           // the angle from the mirrored direction that is left
uniform vec3 objects_middle_m;      // a sphere around all that can be mirrored
uniform float objects_radius_m;
uniform int pixel_rays;             // altogether
uniform int first_ray;              // of those that this run casts
uniform int last_ray;

// Added up over the runs.
layout(location = 0) out vec4 objects;   // weighted light of objects that rays met; a = the weight of all rays
layout(location = 1) out vec4 covered;   // what the probe shows along those rays, weighted
layout(location = 2) out vec4 shown;     // what is mirrored without objects; a = the share of light that is mirrored

// Where the camera looks at the surface from above, and along which direction; false where it does not.
bool sees_surface(vec2 pixel, out vec3 at, out vec3 direction) {
    vec2 normalized = normalized_from_pixel(pixel);
    at = eye_world_m;
    direction = vec3(0.0, 0.0, -1.0);
    if (any(isnan(normalized))) return false;
    direction = normalize(world_from_camera * vec3(normalized, 1.0));
    float height_m = eye_world_m.z - mirror_z_m;
    // Beyond a thousand heights a surface is its horizon.
    const float least_slope = 1e-3;
    if (!(height_m > 0.0) || direction.z > -least_slope) return false;
    at = eye_world_m + direction * (height_m / -direction.z);
    at.z = mirror_z_m;
    return true;
}

// Whether a direction within the lobe, or what the pixel spans beside it, can meet an object.
bool can_mirror(vec3 at, vec3 mirrored, float pixel_span) {
    vec3 to_objects = objects_middle_m - at;
    float distance_m = length(to_objects);
    if (distance_m <= objects_radius_m) return true;
    float apart = acos(clamp(dot(to_objects / distance_m, mirrored), -1.0, 1.0));
    return apart <= asin(objects_radius_m / distance_m) + lobe_reach + pixel_span;
}

// Four numbers that fill the unit hypercube evenly (Roberts 2018, as spread_point).
vec4 spread_point4(uint index, uvec4 start) {
    uvec4 place = start + index * uvec4(3679390609u, 3152041523u, 2700274806u, 2313257605u);
    return vec4(place) * (1.0 / 4294967296.0);
}

void main() {
    objects = covered = shown = vec4(0.0);
    vec2 pixel = vec2(target_texel());
    vec3 at, direction;
    if (!(reflectance > 0.0) || !sees_surface(pixel, at, direction)) return;

    const vec3 up = vec3(0.0, 0.0, 1.0);
    vec3 mirrored = reflect(direction, up);
    // Schlick 1994, "An Inexpensive BRDF Model for Physically-based Rendering", over the lobe (Karis 2013).
    vec2 table = split_sum(-direction.z, roughness);
    float share = reflectance * table.x + table.y;
    // The lobe of a rough surface leans towards the normal.
    if (first_ray == 0)
        shown = vec4(share * reflected_radiance(normalize(mix(mirrored, up, pow(roughness, 4.0))), roughness), share);

    vec3 next_at, next_direction;
    bool sees_next = sees_surface(pixel + 1.0, next_at, next_direction);
    float pixel_span = sees_next ? length(next_direction - direction) : pi;
    if (!can_mirror(at, mirrored, pixel_span)) return;

    // The lobe's variance is shared between where the rays go and how wide each is (see surface/surface.frag).
    const float overlap = 4.0;
    float ray_share = min(overlap / float(4 * pixel_rays), 0.75);
    float ray_roughness = roughness * sqrt(sqrt(ray_share));
    float alpha = roughness * roughness * sqrt(1.0 - ray_share);
    float widest = widest_tangent * roughness * roughness;
    // Four pixels side by side share one sequence.
    uvec2 place = uvec2(target_texel() + 32768);
    uvec4 start;
    start.x = scrambled((place.x >> 1u) + 65536u * (place.y >> 1u));
    start.y = scrambled(start.x);
    start.z = scrambled(start.y);
    start.w = scrambled(start.z);
    uint first = uint(pixel_rays) * ((place.x & 1u) + 2u * (place.y & 1u));
    for (int i = first_ray; i <= last_ray; ++i) {
        vec4 u = spread_point4(first + uint(i), start);
        if (!sees_surface(pixel + u.zw - 0.5, at, direction)) continue;
        vec3 eye = -direction;
        vec3 h = visible_half_vector(eye, alpha, u.xy);
        if (length(h.xy) > widest * h.z) continue;
        vec3 along = reflect(direction, h);
        if (along.z <= 0.0) continue;
        float eye_lambda = smith_lambda(eye.z, alpha);
        float weight = (1.0 + eye_lambda) / (1.0 + eye_lambda + smith_lambda(along.z, alpha));
        objects.a += weight;
        int first_met;
        vec3 light = light_along(point_off(at, up), direction_off(along, up), ray_roughness, false, first_met);
        if (first_met != meets_object) continue;
        objects.rgb += weight * light;
        covered.rgb += weight * reflected_radiance(along, ray_roughness);
    }
}
