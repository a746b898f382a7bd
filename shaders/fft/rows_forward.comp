#version 450 core
// Rows of a real picture, two a work group, to columns 0 … LENGTH / 2 of their transforms: one row is the real part
// and the next the imaginary part of a complex line, whose transform tells them apart by symmetry.
#include "fft/line.glsl"
#ifdef CONDITIONAL
#include "common/condition.glsl"
#endif

uniform sampler2D source;
uniform ivec4 source_region;  // x, y, width, height: the texels that are the picture
uniform ivec2 source_place;   // of the picture's first texel in the transform

layout(rgba32f, binding = 0) writeonly uniform image2D spectrum_re;
layout(rgba32f, binding = 1) writeonly uniform image2D spectrum_im;

// Dark outside of the picture. What is no number, or overflows when summed, would reach every pixel.
vec3 light_at(ivec2 place) {
    ivec2 texel = place - source_place;
    if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, source_region.zw))) return vec3(0.0);
    vec3 light = texelFetch(source, texel + source_region.xy, 0).rgb;
    return mix(clamp(light, -1e30, 1e30), vec3(0.0), isnan(light));
}

void main() {
#ifdef CONDITIONAL
    if (!condition_is_met()) return;
#endif
    int upper = 2 * int(gl_WorkGroupID.x) + source_place.y;
    for (int k = 0; k < RADIX; ++k) {
        re[k] = light_at(ivec2(place_of(k), upper));
        im[k] = light_at(ivec2(place_of(k), upper + 1));
    }
    transform_line();

    vec3 mirrored_re[RADIX];
    vec3 mirrored_im[RADIX];
    barrier();
    for (int k = 0; k < RADIX; ++k) put(place_of(k), re[k]);
    barrier();
    for (int k = 0; k <= RADIX / 2; ++k) mirrored_re[k] = take((LENGTH - place_of(k)) % LENGTH);
    barrier();
    for (int k = 0; k < RADIX; ++k) put(place_of(k), im[k]);
    barrier();
    for (int k = 0; k <= RADIX / 2; ++k) mirrored_im[k] = take((LENGTH - place_of(k)) % LENGTH);

    for (int k = 0; k <= RADIX / 2; ++k) {
        ivec2 upper_row = ivec2(place_of(k), 2 * int(gl_WorkGroupID.x));
        ivec2 lower_row = upper_row + ivec2(0, 1);
        if (upper_row.x <= LENGTH / 2) {
            // upper = (Z + conj Z') / 2, lower = (Z - conj Z') / 2i, Z' mirrored.
            imageStore(spectrum_re, upper_row, vec4(0.5 * (re[k] + mirrored_re[k]), 0.0));
            imageStore(spectrum_im, upper_row, vec4(0.5 * (im[k] - mirrored_im[k]), 0.0));
            imageStore(spectrum_re, lower_row, vec4(0.5 * (im[k] + mirrored_im[k]), 0.0));
            imageStore(spectrum_im, lower_row, vec4(0.5 * (mirrored_re[k] - re[k]), 0.0));
        }
    }
}
