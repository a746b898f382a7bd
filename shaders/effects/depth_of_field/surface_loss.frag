#version 450 core
// What the shadow takes of the real surface's light, over texels of one class.

#include "common/graph.glsl"
#include "common/lens_map.glsl"
#include "effects/contact_shadow/contact_shadow.glsl"
#include "composite/shadow.glsl"

uniform int texel_px;
uniform int samples;  // along a texel's side

layout(location = 0) out vec4 loss;  // rgb

void main() {
    vec2 texel = vec2(target_texel());
    loss = vec4(0.0);
    for (int i = 0; i < samples * samples; ++i) {
        vec2 within = (vec2(i % samples, i / samples) + 0.5) / float(samples);
        vec2 normalized = normalized_from_pixel((texel + within) * float(texel_px) - 0.5);
        if (!any(isnan(normalized))) loss.rgb += 1.0 - shadow_over_pixel(normalized);
    }
    loss /= float(samples * samples);
}
