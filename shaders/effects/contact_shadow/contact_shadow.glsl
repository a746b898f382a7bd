// Looks up the share of the probe's light that still arrives at a point of the surface.

// What the casters take away (rgb) and send back (a): of steep directions around their feet, of flat ones as far as the
// shadow reaches.
uniform sampler2D shadow_fine;
uniform sampler2D shadow_far;
uniform vec4 shadow_fine_rectangle_m;   // min x, min y, width, height on the surface
uniform vec4 shadow_far_rectangle_m;

#ifdef LAMPS
#include "common/lamps.glsl"

// Of analytic lights the maps hold what casters take of them, in the same shares (render/effects/lamp_shadow.h).
uniform float lamp_surface_z_m;
uniform vec3 inverse_reference;   // 1 / what the shares are shares of
uniform vec3 probe_share;         // of it: 1, or 0 where the probe has no light
#endif

// Bilinear; nothing is lost outside the rectangle.
vec4 shadow_loss(sampler2D map, vec4 rectangle_m, vec2 surface_m) {
    ivec2 size = textureSize(map, 0);
    vec2 at = (surface_m - rectangle_m.xy) / rectangle_m.zw * vec2(size) - 0.5;
    if (any(lessThan(at, vec2(0.0))) || any(greaterThan(at, vec2(size - 1)))) return vec4(0.0);
    ivec2 texel = min(ivec2(at), size - 2);
    vec2 t = at - vec2(texel);
    vec4 low = mix(texelFetch(map, texel, 0), texelFetch(map, texel + ivec2(1, 0), 0), t.x);
    vec4 high = mix(texelFetch(map, texel + ivec2(0, 1), 0), texelFetch(map, texel + ivec2(1, 1), 0), t.x);
    return mix(low, high, t.y);
}

vec4 shadow_loss_nearest(sampler2D map, vec4 rectangle_m, vec2 surface_m) {
    vec2 share = (surface_m - rectangle_m.xy) / rectangle_m.zw;
    if (share != clamp(share, 0.0, 1.0)) return vec4(0.0);
    ivec2 size = textureSize(map, 0);
    return texelFetch(map, min(ivec2(share * vec2(size)), size - 1), 0);
}

// What is left, r, is what arrives directly and what the casters return of the surface's own light, which is r times its
// unshadowed light: r = open + returned · r. Sums of shares may pass 1 by their rounding, and what is returned is an
// estimate: a shadow adds no light. Where light bounces (render/effects/bounce_light.h) nothing is returned, and less than
// nothing may be lost.
vec3 light_left(vec4 loss, vec2 surface_m) {
#ifdef LAMPS
    vec3 real = probe_share, all = probe_share;
    for (int i = 0; i < lamp_count; ++i) {
        if (lamp_has(lamps[i], lamp_of_probe)) continue;
        LampLight light = lamp_light(lamps[i], vec3(surface_m, lamp_surface_z_m));
        vec3 share = max(light.to_lamp.z, 0.0) * light.irradiance * inverse_reference;
        all += share;
        if (lamp_has(lamps[i], lamp_in_footage)) real += share;
    }
    vec3 open = all - loss.rgb;
    vec3 left = clamp(open / max(1.0 - loss.a, 0.1), vec3(0.0), max(open, real));
    // What nothing real lights is black in the footage, and no share of it tells what it would be.
    return mix(vec3(1.0), left / max(real, vec3(1e-20)), greaterThan(real, vec3(0.0)));
#else
    vec3 open = 1.0 - loss.rgb;
    return clamp(open / max(1.0 - loss.a, 0.1), vec3(0.0), max(open, vec3(1.0)));
#endif
}

// Light with the casters over light without.
vec3 contact_shadow(vec2 surface_m) {
    return light_left(shadow_loss(shadow_fine, shadow_fine_rectangle_m, surface_m) +
                      shadow_loss(shadow_far, shadow_far_rectangle_m, surface_m), surface_m);
}

// The mean of its channels at the nearest texels, for one look-up of many.
float contact_shadow_nearest(vec2 surface_m) {
    return dot(light_left(shadow_loss_nearest(shadow_fine, shadow_fine_rectangle_m, surface_m) +
                          shadow_loss_nearest(shadow_far, shadow_far_rectangle_m, surface_m), surface_m), vec3(1.0 / 3.0));
}
