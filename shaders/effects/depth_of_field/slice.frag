#version 450 core
// What of a layer has a circle of confusion within a slice: the mean over the pixels of each texel.

#include "common/graph.glsl"

uniform sampler2D light;      // premultiplied, coverage
uniform ivec4 light_region;
uniform ivec4 light_frame;
uniform sampler2D circles;    // x = signed circle in pixels, y = 1 where something is
uniform ivec4 circles_region;
uniform vec2 slice;           // the least circle, and the first that is none of it
uniform int target_scale;     // pixels along a side of a texel

layout(location = 0) out vec4 mean;

void main() {
    ivec2 first = max(target_texel() * target_scale, light_frame.xy);
    ivec2 beyond = min((target_texel() + 1) * target_scale, light_frame.xy + light_frame.zw);
    mean = vec4(0.0);
    for (int y = first.y; y < beyond.y; ++y) {
        for (int x = first.x; x < beyond.x; ++x) {
            vec2 circle = fetch_or_zero(circles, circles_region, ivec2(x, y)).xy;
            if (circle.y > 0.0 && circle.x >= slice.x && circle.x < slice.y)
                mean += fetch_or_zero(light, light_region, ivec2(x, y));
        }
    }
    mean /= float((beyond.x - first.x) * (beyond.y - first.y));
}
