#version 450 core
// Red and blue of the virtual layer, and the coverage that goes with them, displaced along the radius.

#include "common/graph.glsl"

#ifndef CUBIC
#define CUBIC 1
#endif

uniform sampler2D layer;        // premultiplied light, coverage
uniform ivec4 layer_region, layer_frame;
uniform vec2 centre_px;         // of the frame
uniform float corner_px;        // from there
uniform float red_px, blue_px;  // displacement in the corners
uniform float least_px;         // displacements of less are none

layout(location = 0) out vec4 light;
layout(location = 1) out vec4 coverage;  // of red, green, blue

float set_in(float displacement) { return displacement * smoothstep(least_px, 2.0 * least_px, abs(displacement)); }

// Within the frame; beyond the frame's edge the layer goes on as it ends there.
vec4 texel_at(ivec2 texel) {
    ivec2 last = layer_frame.xy + layer_frame.zw - 1;
    return fetch_or_zero(layer, layer_region, clamp(texel, layer_frame.xy, last));
}

vec4 sample_at(vec2 position) {
    ivec2 low = ivec2(floor(position));
    vec2 t = position - vec2(low);
    vec4 nearest[4] = vec4[4](texel_at(low), texel_at(low + ivec2(1, 0)), texel_at(low + ivec2(0, 1)), texel_at(low + ivec2(1, 1)));
#if CUBIC
    // Keys 1981, "Cubic Convolution Interpolation for Digital Image Processing", a = -1/2. Its overshoot would be coverage
    // below 0 or above 1, and light that nothing sends: it is held within the four nearest.
    vec2 t2 = t * t, t3 = t2 * t;
    vec2 weights[4] = vec2[4](-0.5 * t3 + t2 - 0.5 * t, 1.5 * t3 - 2.5 * t2 + 1.0, -1.5 * t3 + 2.0 * t2 + 0.5 * t, 0.5 * t3 - 0.5 * t2);
    vec4 sum = vec4(0.0);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x) sum += weights[x].x * weights[y].y * texel_at(low + ivec2(x, y) - 1);
    vec4 least = min(min(nearest[0], nearest[1]), min(nearest[2], nearest[3]));
    vec4 most = max(max(nearest[0], nearest[1]), max(nearest[2], nearest[3]));
    return clamp(sum, least, most);
#else
    return mix(mix(nearest[0], nearest[1], t.x), mix(nearest[2], nearest[3], t.x), t.y);
#endif
}

// What is shown at `pixel` displaced by `at_corner_px`.
vec4 displaced(vec2 pixel, float at_corner_px, vec4 in_place) {
    vec2 from_centre = pixel - centre_px;
    float radius = length(from_centre);
    float moved = set_in(at_corner_px * radius / corner_px);
    return moved == 0.0 ? in_place : sample_at(pixel - moved * from_centre / radius);
}

void main() {
    ivec2 texel = target_texel();
    vec4 here = fetch_or_zero(layer, layer_region, texel);
    vec4 red = displaced(vec2(texel), red_px, here);
    vec4 blue = displaced(vec2(texel), blue_px, here);
    light = vec4(red.r, here.g, blue.b, here.a);
    coverage = vec4(red.a, here.a, blue.a, 1.0);
}
