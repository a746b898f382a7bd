// Looks up the share of the probe's light that still arrives at a point of the surface.

// What the casters take away: of steep directions around their feet, of flat directions as far as the shadow reaches.
uniform sampler2D shadow_fine;
uniform sampler2D shadow_far;
uniform vec4 shadow_fine_rectangle_m;   // min x, min y, width, height on the surface
uniform vec4 shadow_far_rectangle_m;

// Bilinear; nothing is lost outside the rectangle.
vec3 shadow_loss(sampler2D map, vec4 rectangle_m, vec2 surface_m) {
    ivec2 size = textureSize(map, 0);
    vec2 at = (surface_m - rectangle_m.xy) / rectangle_m.zw * vec2(size) - 0.5;
    if (any(lessThan(at, vec2(0.0))) || any(greaterThan(at, vec2(size - 1)))) return vec3(0.0);
    ivec2 texel = min(ivec2(at), size - 2);
    vec2 t = at - vec2(texel);
    vec3 low = mix(texelFetch(map, texel, 0).rgb, texelFetch(map, texel + ivec2(1, 0), 0).rgb, t.x);
    vec3 high = mix(texelFetch(map, texel + ivec2(0, 1), 0).rgb, texelFetch(map, texel + ivec2(1, 1), 0).rgb, t.x);
    return mix(low, high, t.y);
}

// Light with the casters over light without. Sums of shares may pass 1 by their rounding.
vec3 contact_shadow(vec2 surface_m) {
    return max(vec3(0.0), 1.0 - shadow_loss(shadow_fine, shadow_fine_rectangle_m, surface_m)
                              - shadow_loss(shadow_far, shadow_far_rectangle_m, surface_m));
}
