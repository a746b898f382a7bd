#version 450 core
// Light at the texels of rows along a slanted line.
#include "common/graph.glsl"
#include "effects/streaks/line.glsl"

uniform sampler2D source;
uniform ivec4 source_region;

out vec4 light;

void main() {
    ivec2 texel = target_texel();
    vec2 place = vec2(texel);
    place.MINOR += shift(texel.MAJOR);
    light = linear_or_zero(source, source_region, place);
}
