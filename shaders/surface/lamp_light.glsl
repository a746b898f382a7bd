// What a surface sends to the eye of the light of analytic lights. The lobes are those under the probe: GGX with height-
// correlated masking (Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces"; Heitz 2014), and what
// it loses between facets as if diffuse (common/scattering.glsl). Include common/lamp_shadow.glsl before.

// The normal without what maps make of it, towards the eye: what casts has no maps, and a point is lifted off that.
vec3 unmapped_normal;

struct LampLobe {
    vec3 n;
    vec2 alpha2;   // of its core: along `stretched` and across it
    vec3 stretched;  // unit, in the surface; zero: the lobe is round
};

// What the reflected direction turns by over a pixel, squared.
float pixel_span2(vec3 reflected_dx, vec3 reflected_dy) {
    return 0.5 * (dot(reflected_dx, reflected_dx) + dot(reflected_dy, reflected_dy));
}

// The lobe as wide as what a pixel and the lamp span make it: a pixel that spans an angle f has the variance f²/12, a lamp
// seen as a disc of half angle s has s²/4, and the lobe about the reflection (lobe_width alpha)².
LampLobe widened(LampLobe lobe, float pixel_span2, float lamp_size) {
    lobe.alpha2 = min(lobe.alpha2 + (min(pixel_span2, 1.0) / 12.0 + 0.25 * lamp_size * lamp_size) / (lobe_width * lobe_width), vec2(1.0));
    return lobe;
}

// D · V: the lobe's share of light without Fresnel's, over the cosine.
float lobe_of(LampLobe lobe, vec3 v, vec3 l) {
    vec3 h = normalize(v + l);
    float n_dot_h = dot(lobe.n, h), n_dot_l = dot(lobe.n, l), n_dot_v = dot(lobe.n, v);
    vec3 t = lobe.stretched;
    vec3 b = cross(lobe.n, t);
    // Across a round lobe all directions are one: what is not along n.
    vec2 of_h = t == vec3(0.0) ? vec2(0.0, length(cross(lobe.n, h))) : vec2(dot(t, h), dot(b, h));
    vec2 of_l = t == vec3(0.0) ? vec2(0.0, sqrt(max(1.0 - n_dot_l * n_dot_l, 0.0))) : vec2(dot(t, l), dot(b, l));
    vec2 of_v = t == vec3(0.0) ? vec2(0.0, sqrt(max(1.0 - n_dot_v * n_dot_v, 0.0))) : vec2(dot(t, v), dot(b, v));
    // A facet that is seen is not turned away: rounding alone makes this 0.
    float spread = dot(of_h * of_h, 1.0 / lobe.alpha2) + n_dot_h * n_dot_h;
    float distribution = 1.0 / (pi * sqrt(lobe.alpha2.x * lobe.alpha2.y) * max(spread * spread, 1e-30));
    float masked_l = n_dot_v * sqrt(dot(lobe.alpha2, of_l * of_l) + n_dot_l * n_dot_l);
    float masked_v = n_dot_l * sqrt(dot(lobe.alpha2, of_v * of_v) + n_dot_v * n_dot_v);
    return distribution * 0.5 / max(masked_l + masked_v, 1e-9);
}

vec3 fresnel(vec3 f0, vec3 f90, vec3 v, vec3 l) {
    float away = clamp(1.0 - dot(v, normalize(v + l)), 0.0, 1.0);
    float away2 = away * away;
    return f0 + (f90 - f0) * (away2 * away2 * away);
}

// How a material sends on what arrives from one direction.
struct LampSurface {
    vec3 v;
    LampLobe lobe;
    float pixel_span2;       // of the reflected direction over a pixel, squared
    vec3 diffuse;            // times irradiance over π
    vec3 f0_dielectric, f90_dielectric, f0_metal;
    float metallic;
#ifdef SHEEN
    vec3 sheen_color;
    float sheen_roughness, below_sheen;
#endif
#ifdef COAT
    LampLobe coat;
    float coat_pixel_span2, coat_strength, below_coat;
#endif
};

vec3 lamp_radiance(LampSurface surface, vec3 world_position, vec3 side) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < lamp_count; ++i) {
        Lamp lamp = lamps[i];
        if (lamp_has(lamp, lamp_of_probe)) continue;
        LampLight light = lamp_light(lamp, world_position);
        float cosine = dot(surface.lobe.n, light.to_lamp);
        float most = cosine;
#ifdef COAT
        most = max(most, dot(surface.coat.n, light.to_lamp));
#endif
        if (most <= 0.0 || all(equal(light.irradiance, vec3(0.0)))) continue;
        float left = lamp_share_left(lamp, light, world_position, unmapped_normal, side);
        if (left == 0.0) continue;
        vec3 sent = vec3(0.0);
        if (cosine > 0.0) {
            LampLobe lobe = widened(surface.lobe, surface.pixel_span2, light.size);
            vec3 mirrored = mix(fresnel(surface.f0_dielectric, surface.f90_dielectric, surface.v, light.to_lamp),
                                fresnel(surface.f0_metal, vec3(1.0), surface.v, light.to_lamp), surface.metallic);
            sent = cosine * (surface.diffuse / pi + mirrored * lobe_of(lobe, surface.v, light.to_lamp));
#ifdef SHEEN
            // Estevez & Kulla 2017: the factor that common/material_layers.glsl leaves out.
            mat3 world_from_surface = frame_about(surface.lobe.n);
            float inverse = 1.0 / max(surface.sheen_roughness * surface.sheen_roughness, 1e-3);
            float fibres = (2.0 + inverse) / (8.0 * pi) *
                           sheen_distribution(surface.v * world_from_surface, light.to_lamp * world_from_surface,
                                              surface.sheen_roughness);
            sent = surface.below_sheen * sent + cosine * fibres * surface.sheen_color;
#endif
        }
#ifdef COAT
        sent *= surface.below_coat;
        float coat_cosine = dot(surface.coat.n, light.to_lamp);
        if (coat_cosine > 0.0) {
            LampLobe coat = widened(surface.coat, surface.coat_pixel_span2, light.size);
            sent += coat_cosine * surface.coat_strength * fresnel(dielectric_f0, vec3(1.0), surface.v, light.to_lamp) *
                    lobe_of(coat, surface.v, light.to_lamp);
        }
#endif
        sum += left * sent * light.irradiance;
    }
    return sum;
}
