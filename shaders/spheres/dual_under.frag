#version 450 core
// The layers that were taken off from the back, under those from the front.

uniform sampler2D behind;  // premultiplied

layout(location = 0) out vec4 layer;

void main() { layer = texelFetch(behind, ivec2(gl_FragCoord.xy), 0); }
