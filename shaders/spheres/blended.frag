#version 450 core
// What has been summed without an order, as one layer: premultiplied light, and what it covers.
layout(location = 0) out vec4 layer;

uniform sampler2D summed;
uniform sampler2D beside;  // what is let through (WEIGHTED_BLENDED), what absorbs (BLEND_BY_MOMENTS)

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 sum = texelFetch(summed, pixel, 0);
    if (sum.a <= 0.0) discard;
#if defined(WEIGHTED_SUM)
    // Beyond what covers wholly the sum would take light from what is behind: then it is their mean.
    layer = sum / max(sum.a, 1.0);
#else
#ifdef WEIGHTED_BLENDED
    float alpha = 1.0 - texelFetch(beside, pixel, 0).r;
#else
    float alpha = 1.0 - exp(-texelFetch(beside, pixel, 0).r);
#endif
    layer = vec4(alpha * sum.rgb / sum.a, alpha);
#endif
}
