#version 450 core
// Puts into the depth buffer what hides what is not looked for: the farthest depth that is left, or what is opaque and
// before it; where none is left, a depth nearer than all.

uniform sampler2D depths;  // nearest, farthest
uniform sampler2D opaque_depth;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec2 ends = texelFetch(depths, pixel, 0).rg;
    gl_FragDepth = ends.x < 0.0 ? 1.0 : max(ends.y, texelFetch(opaque_depth, pixel, 0).r);
}
