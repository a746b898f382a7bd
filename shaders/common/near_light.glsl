// The light that arrives along a ray near the real surface: from the surface, as the clip shows it and as it lies in the
// objects' shadow, or from the probe. Include common/environment.glsl and common/visibility.glsl before.
#include "common/surface_picture.glsl"

// Standard deviation of the reflected directions of a GGX lobe's core, in units of alpha.
const float lobe_width = 1.09;

// How wide a lobe lies on the surface: as wide as the two axes of its ellipse would be together.
float footprint_m(vec3 direction, float roughness, float way_m) {
    return 2.0 * lobe_width * roughness * roughness * way_m * inversesqrt(max(-direction.z, 0.01));
}

// How the surface's picture and the probe agree about a direction from the probe's place, to be asked where that place is
// known. Both are taken over a wide lobe, so that a picture that lies a few millimetres beside the truth agrees, too.
struct SurfaceAgreement {
    float mirrored;    // more light than the surface's own: what it mirrors, which for paper, wood and plastic has no colour
    float knowledge;   // of the picture: little where the probe sees something that stands on the surface, or the clip did
};
SurfaceAgreement surface_agreement(vec3 from_probe, float roughness) {
    const float least_roughness = 0.35;   // a lobe of some 8°
    roughness = max(roughness, least_roughness);
    float way_m = (probe_place_m.z - surface_z_m) / max(-from_probe.z, 1e-6);
    vec4 picture = surface_picture(probe_place_m.xy + way_m * from_probe.xy, footprint_m(from_probe, roughness, way_m));
    if (!(picture.a > 0.0)) return SurfaceAgreement(0.0, 0.0);
    vec3 seen = reflected_radiance(from_probe, roughness);
    vec3 more = seen - picture.rgb / picture.a;
    float mirrored = max(min(more.r, min(more.g, more.b)), 0.0);
    vec3 apart = abs(more - mirrored);
    float most = max(max(seen.r, max(seen.g, seen.b)), 1e-20);
    // A tenth is what calibration and gloss leave between two looks at the same paper; a third is another thing.
    float differs = smoothstep(0.1, 1.0 / 3.0, max(apart.r, max(apart.g, apart.b)) / most);
    return SurfaceAgreement(mirrored, picture.a * (1.0 - differs));
}

// From the surface or the probe. A lobe of this roughness spreads over what is seen.
vec3 light_beyond_objects(vec3 from, vec3 direction, float roughness) {
    vec3 met;
    if (!meets_surface(from, direction, met)) return reflected_radiance(direction, roughness);
    vec3 radiance;
    if (surface_is_near == 0) {
        radiance = reflected_radiance(direction, roughness);
    } else {
        float way_m = length(met - from);
        vec3 from_probe = direction_of_place(met, direction);
        vec4 picture = surface_picture(met.xy, footprint_m(direction, roughness, way_m));
        float knowledge = picture.a > 0.0 ? picture.a * surface_agreement(from_probe, roughness).knowledge : 0.0;
        radiance = vec3(0.0);
        if (knowledge < 1.0)
            radiance = (1.0 - knowledge) * reflected_radiance(from_probe, roughness_from_probe(roughness, way_m, met));
        if (knowledge > 0.0) {
            // What the surface mirrors lies far behind it, and is seen in the same direction from everywhere.
            SurfaceAgreement along = surface_agreement(direction, roughness);
            radiance += knowledge * (picture.rgb / picture.a + along.knowledge * along.mirrored);
        }
    }
    return surface_shadow_present != 0 ? radiance * contact_shadow(met.xy) : radiance;
}
