#version 450 core
// Columns of a spectrum in place, one a work group: forwards (FORWARD), backwards (BACK), or both with the product with
// a kernel's spectrum in between.
#include "fft/line.glsl"
#ifdef CONDITIONAL
#include "common/condition.glsl"
#endif

layout(rgba32f, binding = 0) uniform image2D spectrum_re;
layout(rgba32f, binding = 1) uniform image2D spectrum_im;
uniform ivec2 rows_in;  // the first row that holds light and their number; the others are zero and need not be stored
uniform int rows_out;   // rows that are wanted, from the first
#ifdef PRODUCT
uniform sampler2D kernel;  // the spectrum of an even kernel: it is real
uniform float factor;
#endif

void main() {
#ifdef CONDITIONAL
    if (!condition_is_met()) return;
#endif
    int column = int(gl_WorkGroupID.x);
    for (int k = 0; k < RADIX; ++k) {
        int row = place_of(k) - rows_in.x;
        re[k] = vec3(0.0);
        im[k] = vec3(0.0);
        if (row >= 0 && row < rows_in.y) {
            re[k] = imageLoad(spectrum_re, ivec2(column, row)).rgb;
            im[k] = imageLoad(spectrum_im, ivec2(column, row)).rgb;
        }
    }
#ifndef BACK
    transform_line();
#endif
#ifdef PRODUCT
    for (int k = 0; k < RADIX; ++k) {
        vec3 gain = factor * texelFetch(kernel, ivec2(column, place_of(k)), 0).rgb;
        re[k] *= gain;
        im[k] *= gain;
    }
#endif
#ifndef FORWARD
    transform_line_back();
#endif
    for (int k = 0; k < RADIX; ++k) {
        int row = place_of(k);
        if (row < rows_out) {
            imageStore(spectrum_re, ivec2(column, row), vec4(re[k], 0.0));
            imageStore(spectrum_im, ivec2(column, row), vec4(im[k], 0.0));
        }
    }
}
