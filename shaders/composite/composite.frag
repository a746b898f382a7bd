#version 450 core
// One plate region: real light, dimmed where virtual objects stand in it, under the virtual layer, back in code values.
//
// linear = plate · shadow ratio · (1 − α) + virtual · gain (Porter & Duff 1984, "Compositing Digital Images", over).

#include "common/graph.glsl"
#include "common/lens_map.glsl"
#include "common/response.glsl"
#include "effects/contact_shadow/contact_shadow.glsl"
#include "effects/exposure/tone_curve.glsl"

uniform sampler2D plate_code;        // RGB code values of the region; without footage: the background's linear light

uniform sampler2D layer;             // virtual layer: premultiplied radiance in probe units, alpha = coverage
uniform vec4 layer_intrinsics;       // fx, fy, cx, cy of the layer's pinhole, in its pixels (centres at whole numbers)
uniform ivec2 layer_size;            // the part of the texture that was drawn
uniform int layer_present;

uniform float surface_z_m;
uniform int shadow_present;
uniform float least_visible_loss;    // a shadow that takes less than this share of the light is none

uniform mat3 world_from_camera;
uniform vec3 eye_world_m;
uniform vec3 gain;                   // 2^exposure · white balance: plate light of unit probe light
uniform float plate_gain;            // 1 unless the whole picture is exposed anew
uniform vec2 vignette;               // gain = 1 + v.x r² + v.y r⁴
uniform vec3 vignette_frame;         // centre x, centre y, 1 / distance of the corner

#ifdef WRITE_LIGHT
layout(location = 0) out vec4 light_after;        // plate-linear; a = the virtual layer's alpha
layout(location = 1) out vec4 light_before;       // the plate's own; a = 1 where the pixel was touched
#else
layout(location = 0) out vec4 composited_code;    // a = 1 where the pixel was touched
#endif
#ifdef WRITE_LAYERS
layout(location = 2) out vec4 shadow_layer;       // rgb = ratio
layout(location = 3) out vec4 virtual_layer;      // premultiplied plate-linear light, alpha
layout(location = 4) out vec4 geometry;           // world normal, depth in metres; 0 where nothing is
layout(location = 5) out vec4 object;             // r = object id, 0 where nothing is

uniform sampler2D layer_normal;      // one sample a layer pixel
uniform sampler2D layer_depth_m;
uniform usampler2D layer_object_id;
#endif

// A direction's place in the layer, counted from the corner of its first pixel.
vec2 layer_position(vec2 normalized) { return normalized * layer_intrinsics.xy + layer_intrinsics.zw + 0.5; }

// The layer's light over one plate pixel: the exact mean over its footprint, an upright box in the layer.
vec4 layer_over_pixel(vec2 normalized, vec2 footprint) {
    vec2 centre = layer_position(normalized);
    vec2 low = centre - 0.5 * footprint;
    vec2 high = centre + 0.5 * footprint;
    ivec2 first = max(ivec2(floor(low)), ivec2(0));
    ivec2 last = min(ivec2(ceil(high)), layer_size) - 1;
    vec4 sum = vec4(0.0);
    for (int y = first.y; y <= last.y; ++y) {
        float height = min(high.y, float(y + 1)) - max(low.y, float(y));
        for (int x = first.x; x <= last.x; ++x) {
            float width = min(high.x, float(x + 1)) - max(low.x, float(x));
            sum += width * height * texelFetch(layer, ivec2(x, y), 0);
        }
    }
    return sum / (footprint.x * footprint.y);
}

vec3 shadow_over_pixel(vec2 normalized) {
    vec3 direction = world_from_camera * vec3(normalized, 1.0);
    float distance_m = (surface_z_m - eye_world_m.z) / direction.z;
    // Behind the camera, or along the surface: no such point is seen.
    if (!(distance_m > 0.0) || isinf(distance_m)) return vec3(1.0);
    return contact_shadow(eye_world_m.xy + direction.xy * distance_m);
}

void main() {
    ivec2 in_region = ivec2(gl_FragCoord.xy);
    vec2 pixel = vec2(target_texel());
    vec3 code = texelFetch(plate_code, in_region, 0).rgb;
    vec2 normalized = normalized_from_pixel(pixel);

    vec4 virtual_light = vec4(0.0);
    vec3 ratio = vec3(1.0);
    bool reached = !any(isnan(normalized));  // by the lens model
    if (reached && layer_present != 0) {
        // The lens bends: one plate pixel spans more of the layer in one place than in another.
        vec2 next = normalized_from_pixel(pixel + 1.0);
        vec2 footprint = abs(next - normalized) * layer_intrinsics.xy;
        virtual_light = layer_over_pixel(normalized, any(isnan(footprint)) ? vec2(1.0) : clamp(footprint, 1.0, 16.0));
    }
    if (reached && shadow_present != 0) {
        ratio = shadow_over_pixel(normalized);
        if (all(greaterThan(ratio, vec3(1.0 - least_visible_loss)))) ratio = vec3(1.0);
    }

    vec2 from_centre = (pixel - vignette_frame.xy) * vignette_frame.z;
    float r2 = dot(from_centre, from_centre);
    float falloff = 1.0 + vignette.x * r2 + vignette.y * r2 * r2;

#ifdef NO_FOOTAGE
    vec3 plate_linear = code;
#else
    vec3 plate_linear = linear_from_code(code) * plate_gain;
#endif
    vec3 linear = plate_linear * ratio * (1.0 - virtual_light.a) + virtual_light.rgb * gain * falloff;
    bool touched = virtual_light.a > 0.0 || any(greaterThan(virtual_light.rgb, vec3(0.0))) || any(lessThan(ratio, vec3(1.0))) ||
                   white_light > 0.0;
#ifdef NO_FOOTAGE
    touched = true;  // no pixel has been anyone's before
#endif
#ifdef WRITE_LIGHT
    light_after = vec4(touched ? linear : plate_linear, virtual_light.a);
    light_before = vec4(plate_linear, touched ? 1.0 : 0.0);
#else
    composited_code = touched ? vec4(code_from_linear(toned(linear)), 1.0) : vec4(code, 0.0);
#endif
#ifdef WRITE_LAYERS
    shadow_layer = vec4(ratio, 1.0);
    virtual_layer = vec4(virtual_light.rgb * gain * falloff, virtual_light.a);
    geometry = vec4(0.0);
    object = vec4(0.0);
    ivec2 nearest = ivec2(floor(layer_position(normalized)));
    if (reached && layer_present != 0 && all(greaterThanEqual(nearest, ivec2(0))) && all(lessThan(nearest, layer_size))) {
        geometry = vec4(texelFetch(layer_normal, nearest, 0).xyz, texelFetch(layer_depth_m, nearest, 0).r);
        object.r = float(texelFetch(layer_object_id, nearest, 0).r);
    }
#endif
}
