// What arrives at a point from the objects around it, over the hemisphere.
#include "common/environment.glsl"
#include "common/visibility.glsl"
#include "common/near_light.glsl"
#include "common/object_light.glsl"
#include "common/directions.glsl"

uniform int gather_rays;   // altogether
uniform int first_ray;     // of those that this run casts
uniform int last_ray;

// What those rays of a run bring of the irradiance over π, which is the mean over directions spread as the cosine. To an
// object comes besides what the near surface, or a real thing before it, sends more or less than direct.comp has taken for
// it: the probe's light as if it came from far away, past the shadow on the surface.
vec3 gathered(vec3 world_position, vec3 n, bool to_object) {
    // Rays stand for all between them: after a mirror about as curved as it is far away they are spread twice as wide.
    float roughness = sqrt(min(2.0 * inversesqrt(float(gather_rays)), 1.0));
    mat3 world_from_surface = frame_about(n);
    vec3 from = point_off(world_position, n);
    vec3 sum = vec3(0.0);
    for (int i = first_ray; i <= last_ray; ++i) {
        // Everywhere the same directions: neighbours err alike, and what changes slowly stays smooth.
        vec3 along = world_from_surface * cosine_direction(i, gather_rays);
        // Of what is far, and of real things before it, object_shadow() knows.
        vec3 met;
        bool from_surface = to_object && meets_surface(from, along, met);
        int first_met;
        sum += light_along(from, along, roughness, from_surface, first_met);
        if (from_surface && first_met != meets_object)
            sum -= reflected_radiance(along, roughness) * light_left_along(from, along);
    }
    return sum / float(gather_rays);
}
