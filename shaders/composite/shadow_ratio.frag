#version 450 core
// The share of the real surface's light that objects leave it, on plate pixels.

#include "common/graph.glsl"
#include "common/lens_map.glsl"
#include "effects/contact_shadow/contact_shadow.glsl"
#include "composite/shadow.glsl"

layout(location = 0) out vec4 ratio;  // a = 1

void main() {
    vec2 normalized = normalized_from_pixel(vec2(target_texel()));
    ratio = vec4(any(isnan(normalized)) ? vec3(1.0) : visible_shadow(normalized), 1.0);
}
