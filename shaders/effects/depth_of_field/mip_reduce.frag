#version 450 core
// A step down the pyramid of a layer: by [1 3 3 1]/8 both ways (Burt & Adelson 1983, "The Laplacian Pyramid as a Compact
// Image Code"), in which what has much smaller circles than the level is for counts less, and in focus not at all: Lee,
// Kim & Choi's (2009) anisotropic mipmapping against the leakage of sharp light into blurred surroundings.

#include "common/graph.glsl"

uniform sampler2D light;      // premultiplied, coverage; on a level: times weight
uniform ivec4 light_region;
uniform sampler2D shares;     // on a level: see below; on pixels: x = signed circle, y = 1 where something is
uniform ivec4 shares_region;
uniform ivec4 shares_frame;
uniform float full_circle_px; // circles from this on count fully

layout(location = 0) out vec4 weighted;
layout(location = 1) out vec4 share;  // weight · circle, weight, share where nothing is, share that lies in the frame

bool in_frame(ivec2 texel) {
    ivec2 place = texel - shares_frame.xy;
    return all(greaterThanEqual(place, ivec2(0))) && all(lessThan(place, shares_frame.zw));
}

vec4 share_of(ivec2 texel) {
    vec4 stored = fetch_or_zero(shares, shares_region, texel);
#ifdef FROM_PIXELS
    if (!in_frame(texel)) return vec4(0.0);
    return stored.y > 0.0 ? vec4(abs(stored.x), 1.0, 0.0, 1.0) : vec4(0.0, 0.0, 1.0, 1.0);
#else
    ivec2 place = texel - shares_region.xy;
    bool is_stored = all(greaterThanEqual(place, ivec2(0))) && all(lessThan(place, shares_region.zw));
    return is_stored || !in_frame(texel) ? stored : vec4(0.0, 0.0, 1.0, 1.0);
#endif
}

void main() {
    const float taps[4] = float[](0.125, 0.375, 0.375, 0.125);
    ivec2 first = 2 * target_texel() - 1;
    weighted = vec4(0.0);
    share = vec4(0.0);
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 4; ++x) {
            ivec2 texel = first + ivec2(x, y);
            float tap = taps[x] * taps[y];
            vec4 from = share_of(texel);
            float weight = from.y > 0.0 ? tap * min(from.x / (from.y * full_circle_px), 1.0) : 0.0;
            weighted += weight * fetch_or_zero(light, light_region, texel);
            share += vec4(weight * from.xy, tap * from.zw);
        }
    }
}
