#version 450 core
// One picture of the virtual layer, weighted, for a sum by blending.

uniform sampler2D picture;
uniform float weight;

layout(location = 0) out vec4 weighted;

void main() { weighted = weight * texelFetch(picture, ivec2(gl_FragCoord.xy), 0); }
