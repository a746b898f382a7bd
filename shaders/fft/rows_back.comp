#version 450 core
// Rows of half a spectrum, two a work group, back to the real picture (see rows_forward.comp).
#include "fft/line.glsl"
#ifdef CONDITIONAL
#include "common/condition.glsl"
#endif

uniform sampler2D spectrum_re;
uniform sampler2D spectrum_im;
uniform ivec2 picture_size;  // what is wanted of it, from the transform's first place
uniform float factor;

layout(binding = 0) writeonly uniform image2D picture;

void main() {
#ifdef CONDITIONAL
    if (!condition_is_met()) return;
#endif
    int upper = 2 * int(gl_WorkGroupID.x);
    for (int k = 0; k < RADIX; ++k) {
        int place = place_of(k);
        // The other half mirrors this one: X[-k] = conj X[k] for each of the two real rows.
        bool mirrored = place > LENGTH / 2;
        ivec2 at = ivec2(mirrored ? LENGTH - place : place, upper);
        float turned = mirrored ? -1.0 : 1.0;
        vec3 a_re = texelFetch(spectrum_re, at, 0).rgb;
        vec3 a_im = texelFetch(spectrum_im, at, 0).rgb * turned;
        vec3 b_re = texelFetch(spectrum_re, at + ivec2(0, 1), 0).rgb;
        vec3 b_im = texelFetch(spectrum_im, at + ivec2(0, 1), 0).rgb * turned;
        re[k] = a_re - b_im;
        im[k] = a_im + b_re;
    }
    transform_line_back();
    for (int k = 0; k < RADIX; ++k) {
        ivec2 at = ivec2(place_of(k), upper);
        if (at.x < picture_size.x) {
            imageStore(picture, at, vec4(factor * re[k], 0.0));
            if (at.y + 1 < picture_size.y) imageStore(picture, at + ivec2(0, 1), vec4(factor * im[k], 0.0));
        }
    }
}
