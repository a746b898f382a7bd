#version 450 core
// The mean over the part of the source that a texel covers, which need not be whole texels.
#include "common/graph.glsl"

uniform sampler2D source;
uniform ivec4 source_region;
uniform vec2 footprint;  // source texels along the sides of a texel written

out vec4 light;

void main() {
    vec2 low = vec2(target_texel()) * footprint;
    vec2 high = low + footprint;
    ivec2 first = ivec2(floor(low));
    ivec2 last = ivec2(ceil(high)) - 1;
    light = vec4(0.0);
    for (int y = first.y; y <= last.y; ++y) {
        float rows = min(float(y + 1), high.y) - max(float(y), low.y);
        for (int x = first.x; x <= last.x; ++x) {
            float columns = min(float(x + 1), high.x) - max(float(x), low.x);
            light += max(rows, 0.0) * max(columns, 0.0) * fetch_or_zero(source, source_region, ivec2(x, y));
        }
    }
    light /= footprint.x * footprint.y;
}
