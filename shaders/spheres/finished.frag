#version 450 core
// Puts a depth nearer than all where no further layer is looked for, so that everything there counts as hidden.

uniform usampler2D nearest_id;  // of the layer in front
uniform sampler2D covered;      // by the layers in front: alpha
uniform float enough;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    // Where the layer before had no sphere there is none behind it.
    if (texelFetch(nearest_id, pixel, 0).r != 0u && texelFetch(covered, pixel, 0).a < enough) discard;
    gl_FragDepth = 1.0;
}
