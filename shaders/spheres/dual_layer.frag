#version 450 core
// Which sphere was found at the nearest depth, or (FARTHEST) at the farthest.

uniform sampler2D depths;  // nearest, farthest
uniform usampler2D found_id, found_count;

layout(location = 0) out uint seen;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    if (texelFetch(found_count, pixel, 0).r == 0u) discard;
    seen = texelFetch(found_id, pixel, 0).r;
#ifdef FARTHEST
    gl_FragDepth = texelFetch(depths, pixel, 0).g;
#else
    gl_FragDepth = texelFetch(depths, pixel, 0).r;
#endif
}
