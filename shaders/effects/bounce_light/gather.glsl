// What arrives at a point from the objects around it, over the hemisphere.
#include "common/environment.glsl"
#include "common/visibility.glsl"
#include "common/near_light.glsl"
#include "common/object_light.glsl"
#include "common/directions.glsl"

uniform int gather_rays;   // altogether
uniform int first_ray;     // of those that this run casts
uniform int last_ray;

// What those rays of a run bring of the irradiance over π, which is the mean over directions spread as the cosine.
vec3 gathered(vec3 world_position, vec3 n) {
    // Rays stand for all between them: after a mirror about as curved as it is far away they are spread twice as wide.
    float roughness = sqrt(min(2.0 * inversesqrt(float(gather_rays)), 1.0));
    mat3 world_from_surface = frame_about(n);
    vec3 from = point_off(world_position, n);
    vec3 sum = vec3(0.0);
    for (int i = first_ray; i <= last_ray; ++i) {
        // Everywhere the same directions: neighbours err alike, and what changes slowly stays smooth.
        vec2 u = spread_point(uint(i), uvec2(1u << 30u));
        float r = sqrt(u.x);
        vec3 direction = vec3(r * cos(2.0 * pi * u.y), r * sin(2.0 * pi * u.y), sqrt(max(1.0 - u.x, 1e-6)));
        sum += light_along(from, world_from_surface * direction, roughness, false);
    }
    return sum / float(gather_rays);
}
