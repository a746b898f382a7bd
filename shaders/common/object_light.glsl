// The light that arrives along a ray from other objects, or from beyond them. Include common/near_light.glsl before.
#include "common/rays.glsl"
#include "common/scattering.glsl"

uniform samplerBuffer ray_radiosity;   // of a vertex: what it sends diffusely, emission included
uniform samplerBuffer ray_emission;
uniform int ray_bounces;   // mirrors within mirrors that are followed

// What a ray meets first.
const int meets_nothing = 0;   // but perhaps the real surface
const int meets_object = 1;
const int meets_real = 2;

// Along a ray from `from`, whose lobe has `roughness`; without `beyond_objects` only what an object sends or mirrors.
vec3 light_along(vec3 from, vec3 direction, float roughness, bool beyond_objects, out int first_met) {
    const float farthest = 3.4e38;
    const float least_share = 0.005;   // what is left of a ray that many mirrors took from
    vec3 light = vec3(0.0);
    vec3 share = vec3(1.0);
    first_met = meets_nothing;
    for (int bounce = 0; bounce <= ray_bounces; ++bounce) {
        RayHit hit = RayHit(farthest, -1, 0, vec2(0.0));
        if (any(greaterThan(share, vec3(least_share)))) {
            vec3 met;
            float to_surface_m = meets_surface(from, direction, met) ? length(met - from) : farthest;
            hit = nearest_hit(from, direction, to_surface_m);
        }
        if (hit.instance < 0) {
            if (bounce > 0 || beyond_objects) light += share * light_beyond_objects(from, direction, roughness);
            break;
        }
        if (is_real(hit)) {
            if (bounce == 0) first_met = meets_real;
            if (bounce > 0 || beyond_objects) {
                vec3 met = from + hit.distance_m * direction;
                light += share * reflected_radiance(direction_of_place(met, direction),
                                                    roughness_from_probe(roughness, hit.distance_m, met));
            }
            break;
        }
        if (bounce == 0) first_met = meets_object;
        RaySurface surface = surface_at(hit, from, direction);
        // Light is kept for the side of the normals; what arrives behind a sheet is not known, and taken as none.
        for (int i = 0; i < 3; ++i) {
            vec4 sent = surface.is_back ? texelFetch(ray_emission, surface.vertices[i])
                                        : texelFetch(ray_radiosity, surface.vertices[i]);
            light += share * surface.shares[i] * sent.rgb;
        }
#ifdef RAY_SPHERES
        // Their light is kept nowhere: the probe's is found as it is met.
        if (is_ray_sphere(hit)) {
            const float mean_cosine = 2.0 / 3.0;  // as in effects/bounce_light/radiosity.comp
            vec2 table = split_sum(mean_cosine, surface.roughness);
            light += share * diffuse_radiance(surface.world_normal) *
                     material_scattering(surface.base, surface.metallic, table).diffuse;
        }
#endif
        float cosine = max(dot(surface.world_normal, -direction), 1e-4);
        share *= material_scattering(surface.base, surface.metallic, split_sum(cosine, surface.roughness)).mirrored;
        direction = direction_off(reflect(direction, surface.world_normal), surface.geometric_normal);
        from = point_off(surface.world_position, surface.geometric_normal);
        roughness = min(sqrt(sqrt(pow(roughness, 4.0) + pow(surface.roughness, 4.0))), 1.0);
    }
    return light;
}

vec3 light_along(vec3 from, vec3 direction, float roughness, bool beyond_objects) {
    int first_met;
    return light_along(from, direction, roughness, beyond_objects, first_met);
}
