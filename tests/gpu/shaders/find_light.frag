#version 450 core
// Copies, and meets the condition where there is light.
#include "common/condition.glsl"
uniform sampler2D source;
layout(location = 0) out vec4 color;
void main() {
    color = texelFetch(source, ivec2(gl_FragCoord.xy), 0);
    if (color.r > 0.0) meet_condition();
}
