#version 450 core
// Heat that flows along lines, one an invocation, as far as the circles of confusion let it: Kass, Lefohn & Owens 2006,
// "Interactive Depth of Field Using Simulated Diffusion". One implicit step,
//     (1 + b[i-1] + b[i]) y[i] - b[i-1] y[i-1] - b[i] y[i+1] = x[i],
// b[i] the conductivity between texel i and the next; nothing flows over the line's ends.
//
// Solved after Thomas with w = 1 + c carried instead of c, whose difference to -1 is what float loses where b is large.

#ifndef STEP
#define STEP ivec2(1, 0)
#endif
#define ACROSS ivec2(STEP.y, STEP.x)

layout(local_size_x = 16) in;

uniform sampler2D light;    // premultiplied, coverage; over the same texels as all others
uniform sampler2D circles;  // x = signed circle in pixels, y = 1 where something is
uniform ivec2 line_size;    // texels of a line, lines
uniform float steps;        // that the whole blur takes
uniform float least_coc_px;

layout(rgba32f, binding = 0) uniform image2D solved;
layout(rg32f, binding = 1) uniform image2D filled;             // circles everywhere along lines that have one
layout(r32f, binding = 2) uniform image2D share_of_next;       // b[i] / (what divides texel i's equation)

// The variance of a uniform line is 2 b a step, that of a disc of diameter c is c²/16 along an axis.
float conductivity(float circle_px) {
    return circle_px < least_coc_px ? 0.0 : circle_px * circle_px / (32.0 * steps);
}

// Where nothing is, light goes on with circles between those of what is beside it.
void fill_circles(ivec2 first) {
    int last_known = -1;
    float last_circle = 0.0;
    for (int i = 0; i < line_size.x; ++i) {
        vec2 circle = texelFetch(circles, first + i * STEP, 0).xy;
        if (circle.y == 0.0) continue;
        float here = abs(circle.x);
        for (int k = last_known + 1; k < i; ++k) {
            float between = last_known < 0 ? here : mix(last_circle, here, float(k - last_known) / float(i - last_known));
            imageStore(filled, first + k * STEP, vec4(between, 1.0, 0.0, 0.0));
        }
        imageStore(filled, first + i * STEP, vec4(here, 1.0, 0.0, 0.0));
        last_known = i;
        last_circle = here;
    }
    vec4 rest = last_known < 0 ? vec4(0.0) : vec4(last_circle, 1.0, 0.0, 0.0);
    for (int k = last_known + 1; k < line_size.x; ++k) imageStore(filled, first + k * STEP, rest);
}

void main() {
    int line = int(gl_GlobalInvocationID.x);
    if (line >= line_size.y) return;
    ivec2 first = line * ACROSS;
    fill_circles(first);

    float here = conductivity(imageLoad(filled, first).x);
    float before = 0.0;          // conductivity from the last texel
    float w = 0.0;
    vec4 carried = vec4(0.0);
    for (int i = 0; i < line_size.x; ++i) {
        ivec2 place = first + i * STEP;
        float next = i + 1 < line_size.x ? conductivity(imageLoad(filled, place + STEP).x) : 0.0;
        float after = min(here, next);
        float own = 1.0 + before * w;
        float divisor = own + after;
        carried = (texelFetch(light, place, 0) + before * carried) / divisor;
        w = own / divisor;
        imageStore(solved, place, carried);
        imageStore(share_of_next, place, vec4(after / divisor));
        before = after;
        here = next;
    }
    vec4 last = vec4(0.0);
    for (int i = line_size.x - 1; i >= 0; --i) {
        ivec2 place = first + i * STEP;
        last = imageLoad(solved, place) + imageLoad(share_of_next, place).r * last;
        imageStore(solved, place, last);
    }
}
