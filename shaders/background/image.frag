#version 450 core
// A picture as background, pixel for pixel.
#include "common/graph.glsl"

uniform sampler2D source;  // scene-linear
uniform vec3 gain;

layout(location = 0) out vec4 light;

void main() { light = vec4(texelFetch(source, target_texel(), 0).rgb * gain, 0.0); }
