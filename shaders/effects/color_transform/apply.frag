#version 450 core
// The codes of the virtual layer's colours transformed; coverage stays.

#include "common/color_models.glsl"
#include "common/graph.glsl"

#ifndef MODEL
#define MODEL 0  // 1: HSV, 2: YIQ
#define GREY 0   // 1: HSV's value, 2: mean, 3: YIQ's luma
#define TABLE 0
#define MASK 0
#endif

uniform sampler2D layer;  // premultiplied light, coverage
uniform ivec4 layer_region;
uniform vec3 gain;        // picture-linear light of unit light
uniform mat3 weights;     // of channels
uniform vec3 model;       // hue in sixths of a turn (HSV) or radians (YIQ), then factors of saturation and value
uniform float contrast, brightness;
uniform sampler2D table;  // a cube of colours: red across, green and blue down
uniform int table_size;
uniform vec3 tint;
uniform vec4 fade;        // colour, share
uniform sampler2D mask;
uniform vec4 mask_frame;  // where the mask lies: corner, size

layout(location = 0) out vec4 light;

// IEC 61966-2-1, continued above 1.
vec3 code_from_linear(vec3 linear) {
    return mix(1.055 * pow(max(linear, 0.0031308), vec3(1.0 / 2.4)) - 0.055, 12.92 * linear, lessThanEqual(linear, vec3(0.0031308)));
}
vec3 linear_from_code(vec3 code) {
    return mix(pow((max(code, 0.04045) + 0.055) / 1.055, vec3(2.4)), code / 12.92, lessThanEqual(code, vec3(0.04045)));
}

#if MODEL == 1
vec3 changed(vec3 rgb) {
    vec3 hsv = hsv_from_rgb(max(rgb, 0.0));
    return rgb_from_hsv(vec3(mod(hsv.x + model.x, 6.0), min(hsv.y * model.y, 1.0), hsv.z * model.z));
}
#elif MODEL == 2
vec3 changed(vec3 rgb) {
    vec3 yiq = yiq_from_rgb * rgb;
    float c = cos(model.x), s = sin(model.x);
    return rgb_from_yiq * vec3(yiq.x * model.z, model.y * (mat2(c, s, -s, c) * yiq.yz));
}
#endif

#if TABLE
vec3 node(ivec3 place) { return texelFetch(table, ivec2(place.r, place.b * table_size + place.g), 0).rgb; }

// Linear in the six tetrahedra along a cell's diagonal (Kasson et al. 1993). What is brighter than white keeps by how much.
vec3 looked_up(vec3 code) {
    vec3 inside = clamp(code, 0.0, 1.0), place = inside * float(table_size - 1);
    ivec3 low = min(ivec3(place), table_size - 2);
    vec3 t = place - vec3(low);
    ivec3 first = t.r >= t.g ? (t.r >= t.b ? ivec3(1, 0, 0) : ivec3(0, 0, 1)) : (t.g >= t.b ? ivec3(0, 1, 0) : ivec3(0, 0, 1));
    ivec3 last = t.r < t.g ? (t.r < t.b ? ivec3(1, 0, 0) : ivec3(0, 0, 1)) : (t.g < t.b ? ivec3(0, 1, 0) : ivec3(0, 0, 1));
    float most = max(max(t.r, t.g), t.b), least = min(min(t.r, t.g), t.b), middle = t.r + t.g + t.b - most - least;
    return (1.0 - most) * node(low) + (most - middle) * node(low + first) + (middle - least) * node(low + 1 - last) +
           least * node(low + 1) + (code - inside);
}
#endif

vec3 transformed(vec3 code) {
    code = weights * code;
#if MODEL
    code = changed(code);
#endif
    code = code * contrast + (0.5 - 0.5 * contrast + brightness);
#if TABLE
    code = looked_up(code);
#endif
#if GREY == 1
    code = tint * max(max(code.r, code.g), code.b);
#elif GREY == 2
    code = tint * (code.r + code.g + code.b) / 3.0;
#elif GREY == 3
    code = tint * (yiq_from_rgb * code).x;
#endif
    return max(mix(code, fade.rgb, fade.a), 0.0);
}

void main() {
    ivec2 texel = target_texel();
    light = fetch_or_zero(layer, layer_region, texel);
    // Light that covers nothing has no colour of its own.
    if (light.a <= 0.0) return;
    vec3 code = code_from_linear(max(light.rgb / light.a * gain, 0.0));
    vec3 made = transformed(code), after = light.a * linear_from_code(made) / gain;
    // Codes that stay leave the light as it is, to the bit: nothing is gained by a way there and back.
    after = mix(after, light.rgb, equal(made, code));
#if MASK
    float share = texture(mask, (vec2(texel) + 0.5 - mask_frame.xy) / mask_frame.zw).r;
    after = mix(light.rgb, after, share);
#endif
    light.rgb = after;
}
