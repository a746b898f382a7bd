#version 450 core
// White noise of variance 1 in each channel: a pure function of seed, frame and pixel, by whole numbers and a table
// alone, so that every GPU draws the same.

#include "common/graph.glsl"

uniform sampler2D quantiles;  // equally probable values of a normal distribution
uniform int quantile_bits;
uniform uint frame;
uniform uint seed;

out vec4 noise;

// Jarzynski & Olano 2020, "Hash Functions for GPU Rendering" (JCGT 9(3)).
uvec4 pcg4d(uvec4 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> 16u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

float normal(uint word) { return texelFetch(quantiles, ivec2(int(word >> uint(32 - quantile_bits)), 0), 0).r; }

void main() {
    uvec4 words = pcg4d(uvec4(target_texel(), frame, seed));
    noise = vec4(normal(words.x), normal(words.y), normal(words.z), 0.0);
}
