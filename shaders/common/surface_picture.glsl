// What the real surface sends out, as the clip showed it (render/surface_picture_map.h).

uniform sampler2D surface_picture_texels;  // rgb: probe-unit radiance · knowledge, a: knowledge
uniform float surface_picture_texel_m;     // 0: there is no picture
uniform vec2 surface_picture_corner_m;     // least x and y
uniform vec2 surface_picture_size_m;

// Around the point of the plane, over about `footprint_m`: premultiplied radiance in probe units, and how well it is known:
// 0 beyond the picture, towards whose border it falls over the footprint's width.
vec4 surface_picture(vec2 xy_m, float footprint_m) {
    if (!(surface_picture_texel_m > 0.0) || any(isnan(xy_m))) return vec4(0.0);
    float width_m = max(footprint_m, surface_picture_texel_m);
    vec2 from_corner_m = xy_m - surface_picture_corner_m;
    vec2 from_border_m = min(from_corner_m, surface_picture_size_m - from_corner_m);
    float inside = clamp(min(from_border_m.x, from_border_m.y) / width_m, 0.0, 1.0);
    if (!(inside > 0.0)) return vec4(0.0);
    float level = log2(width_m / surface_picture_texel_m);
    return inside * textureLod(surface_picture_texels, from_corner_m / surface_picture_size_m, level);
}
