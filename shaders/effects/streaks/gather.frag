#version 450 core
// The streaks of one line, brought back from the line's rows to the frame's and added to those of earlier lines.
#include "common/graph.glsl"
#include "effects/streaks/line.glsl"

uniform sampler2D streaks;
uniform ivec4 streaks_region;
#ifdef EARLIER
uniform sampler2D earlier;
uniform ivec4 earlier_region;
#endif

out vec4 light;

void main() {
    ivec2 texel = target_texel();
#ifdef WHOLE
    light = fetch_or_zero(streaks, streaks_region, texel);
#else
    float place = float(texel.MINOR) - shift(texel.MAJOR);
    ivec2 low = texel;
    low.MINOR = int(floor(place));
    ivec2 high = low;
    high.MINOR += 1;
    light = mix(fetch_or_zero(streaks, streaks_region, low), fetch_or_zero(streaks, streaks_region, high),
                         place - floor(place));
#endif
#ifdef EARLIER
    light += fetch_or_zero(earlier, earlier_region, texel);
#endif
}
