#version 450 core
// The luminance of a block of pixels: sum of logarithms, how many, and the greatest.
#include "common/graph.glsl"

uniform sampler2D light;
uniform ivec4 light_region;
uniform int block_px;
uniform float black_luminance;  // at or below it nothing is metered

layout(location = 0) out vec4 reading;

void main() {
    ivec2 first = max(target_texel() * block_px, light_region.xy);
    ivec2 last = min((target_texel() + 1) * block_px, light_region.xy + light_region.zw);
    const float largest_finite = 3.4028235e38;
    float sum = 0.0, count = 0.0, greatest = -200.0;
    for (int y = first.y; y < last.y; ++y) {
        for (int x = first.x; x < last.x; ++x) {
            float luminance = dot(texelFetch(light, ivec2(x, y) - light_region.xy, 0).rgb, vec3(0.2126, 0.7152, 0.0722));
            // Neither holds for what is not a number.
            if (!(luminance > black_luminance && luminance <= largest_finite)) continue;
            float log_luminance = log2(luminance);
            sum += log_luminance;
            count += 1.0;
            greatest = max(greatest, log_luminance);
        }
    }
    reading = vec4(sum, count, greatest, 0.0);
}
