#version 450 core
// The layers that were peeled off, all at once, over what is behind them.

uniform sampler2D peeled_light;  // premultiplied
uniform sampler2D first_depth;   // near_m / z of the first layer

layout(location = 0) out vec4 color;
#ifdef LENS
layout(location = 1) out vec4 focus_share;
#endif
#ifdef COVERAGE
layout(location = COVERAGE) out vec4 coverage;
#endif

const float largest_half = 65504.0;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 light = texelFetch(peeled_light, pixel, 0);
    if (light.a <= 0.0) discard;
    color = vec4(min(light.rgb, vec3(largest_half)), light.a);
#ifdef LENS
    // Blurred as the first of them is.
    focus_share = vec4(light.a * texelFetch(first_depth, pixel, 0).r, 0.0, 0.0, light.a);
#endif
#ifdef COVERAGE
    coverage = vec4(light.a);
#endif
}
