#version 450 core
// The share of the surface's light that is left, where its circle of confusion is of one class.

#include "common/graph.glsl"
#include "common/lens_map.glsl"
#include "effects/contact_shadow/contact_shadow.glsl"
#include "composite/shadow.glsl"
#include "effects/depth_of_field/surface_circle.glsl"

uniform sampler2D blurred;
uniform ivec4 blurred_region;
uniform int texel_px;
uniform int drawn_class;  // -1: sharp

layout(location = 0) out vec4 ratio;  // a = 1

void main() {
    vec2 pixel = vec2(target_texel());
    float width_px = abs(surface_circle(pixel).coc_px);
    int own_class = isnan(width_px) || width_px < least_coc_px ? -1 : surface_class(width_px);
    if (own_class != drawn_class) discard;
    ratio = vec4(1.0);
    if (own_class < 0) {
        vec2 normalized = normalized_from_pixel(pixel);
        if (!any(isnan(normalized))) ratio.rgb = visible_shadow(normalized);
        return;
    }
    vec3 loss = linear_or_zero(blurred, blurred_region, (pixel + 0.5) / float(texel_px) - 0.5).rgb;
    if (any(greaterThanEqual(abs(loss), vec3(max(least_visible_loss, 1e-6))))) ratio.rgb = 1.0 - loss;
}
