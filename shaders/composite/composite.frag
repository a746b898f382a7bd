#version 450 core
// One plate region: real light, dimmed where virtual objects stand in it, under the virtual layer, back in code values.
//
// linear = (plate · shadow ratio + what the surface mirrors of objects) · (1 − α) + virtual · gain (Porter & Duff 1984,
// "Compositing Digital Images", over).

#include "common/graph.glsl"
#include "common/lens_map.glsl"
#include "common/response.glsl"
#include "effects/contact_shadow/contact_shadow.glsl"
#include "effects/exposure/tone_curve.glsl"
#include "composite/layer.glsl"
#include "composite/shadow.glsl"
#if defined(GRAIN) && !defined(WRITE_LIGHT)
#include "effects/grain/grain.glsl"
#endif

uniform sampler2D plate_code;        // RGB code values of the region; without footage: the background's linear light

#ifdef BLURRED_LAYER
uniform sampler2D blurred_layer;     // as `layer`, in plate pixels
uniform ivec4 blurred_layer_region;
#endif
#ifdef CHANNEL_COVERAGE
uniform sampler2D channel_coverage;  // of red, green and blue, in plate pixels
uniform ivec4 channel_coverage_region;
#endif
#ifdef BLURRED_SHADOW
uniform sampler2D blurred_shadow;    // share of the surface's light, in plate pixels; a = 1 where there is one
uniform ivec4 blurred_shadow_region;
#endif
#ifdef HOLDOUTS
uniform sampler2D holdouts;          // share of their light that is left, premultiplied; a = coverage
uniform ivec4 holdouts_region;
#endif
#ifdef REAL_DEPTH
uniform sampler2D real_inverse_depth;  // 1/m along the camera's z, over the frame; 0 where it is not known
#endif
#ifdef MATTE
uniform sampler2D matte;             // share of the pixel that is real and in front of everything virtual
#endif

#ifdef REFLECTION
#include "composite/reflection.glsl"
#endif

#ifdef UNCLIPPED
// Of clipped pixels: plate-linear light as other frames know it, before any gain of ours, and how well; a = 0 elsewhere.
uniform sampler2D unclipped_light;
uniform float clipped_code;          // from here on a code tells the light only from below
#endif

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
#ifdef PLATE_SHARE
layout(location = PLATE_SHARE) out vec4 plate_share;  // of the plate's light in `light_after`, with its noise
#endif
#ifdef REFLECTION_LAYER
layout(location = REFLECTION_LAYER) out vec4 reflection_layer;  // rgb = light, signed
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

void main() {
    ivec2 in_region = ivec2(gl_FragCoord.xy);
    vec2 pixel = vec2(target_texel());
    vec3 code = texelFetch(plate_code, in_region, 0).rgb;
    vec2 normalized = normalized_from_pixel(pixel);

    vec4 virtual_light = vec4(0.0);
    vec3 ratio = vec3(1.0);
    bool reached = !any(isnan(normalized));  // by the lens model
#ifdef BLURRED_LAYER
    virtual_light = fetch_or_zero(blurred_layer, blurred_layer_region, ivec2(pixel));
#else
    if (reached && layer_present != 0) virtual_light = layer_over_pixel(ivec2(pixel), normalized);
#endif
#ifdef CHANNEL_COVERAGE
    vec3 coverage = fetch_or_zero(channel_coverage, channel_coverage_region, ivec2(pixel)).rgb;
#else
    vec3 coverage = vec3(virtual_light.a);
#endif
#ifdef BLURRED_SHADOW
    vec4 blurred_ratio = fetch_or_zero(blurred_shadow, blurred_shadow_region, ivec2(pixel));
    if (blurred_ratio.a > 0.0) ratio = blurred_ratio.rgb;
#else
    if (reached && shadow_present != 0) ratio = visible_shadow(normalized);
#endif

    float surface_share = 1.0;  // of the pixel: the rest is something before the surface
#ifdef REAL_DEPTH
    // What is nearer than the surface is not the surface. Depths are good to a percent or so: not by less than that.
    float nearer = texelFetch(real_inverse_depth, ivec2(pixel), 0).r * surface_distance_m(normalized);
    surface_share = 1.0 - smoothstep(1.01, 1.03, nearer);
    ratio = mix(vec3(1.0), ratio, surface_share);
#endif
#ifdef HOLDOUTS
    // Their own shadow in place of the surface's behind them.
    vec4 holdout = fetch_or_zero(holdouts, holdouts_region, ivec2(pixel));
    if (holdout.a > 0.0) {
        surface_share *= max(1.0 - holdout.a, 0.0);
        ratio = ratio * max(1.0 - holdout.a, 0.0) + holdout.rgb;
        if (all(greaterThan(ratio, vec3(1.0 - max(least_visible_loss, 1e-6))))) ratio = vec3(1.0);
    }
#endif
#ifdef MATTE
    // What lens and shutter blurred is behind: the matte's own blur is the footage's. Real things cast the plate's own
    // shadows, and none of a virtual thing falls on them here.
    float in_front = texelFetch(matte, in_region, 0).r;
    virtual_light *= 1.0 - in_front;
    coverage *= 1.0 - in_front;
    surface_share *= 1.0 - in_front;
    ratio = mix(ratio, vec3(1.0), in_front);
#endif

    vec2 from_centre = (pixel - vignette_frame.xy) * vignette_frame.z;
    float r2 = dot(from_centre, from_centre);
    float falloff = 1.0 + vignette.x * r2 + vignette.y * r2 * r2;

#ifdef NO_FOOTAGE
    vec3 plate_linear = code * falloff;
#else
    vec3 plate_linear = linear_from_code(code) * plate_gain;
#endif
#ifdef UNCLIPPED
    // The nearer a code is to the top, the less it says itself.
    vec4 known = texelFetch(unclipped_light, in_region, 0);
    vec3 share = clamp((code - clipped_code) / (1.0 - clipped_code), 0.0, 1.0) * known.a;
    if (any(lessThan(ratio, vec3(1.0)))) plate_linear = max(plate_linear, mix(plate_linear, known.rgb * plate_gain, share));
#endif
    vec3 linear = plate_linear * ratio * (1.0 - coverage) + virtual_light.rgb * gain * falloff;
#ifdef REFLECTION
    vec3 mirrored = surface_share * mirrored_change(in_region, plate_linear, ratio, gain * falloff) * (1.0 - coverage);
    // Rounding alone can bring it below 0, where only colours beyond Rec.709 have been before.
    linear = max(linear + mirrored, min(linear, vec3(0.0)));
#endif
#ifdef NO_FOOTAGE
    vec3 kept = vec3(0.0);  // a background has no noise of its own
#else
    vec3 kept = ratio * (1.0 - coverage);
#endif
    bool touched = any(greaterThan(coverage, vec3(0.0))) || any(greaterThan(virtual_light.rgb, vec3(0.0))) || any(notEqual(ratio, vec3(1.0))) ||
                   white_light > 0.0;
#ifdef REFLECTION
    touched = touched || any(notEqual(mirrored, vec3(0.0)));
#endif
#ifdef NO_FOOTAGE
    touched = true;  // no pixel has been anyone's before
#endif
#ifdef WRITE_LIGHT
    light_after = vec4(touched ? linear : plate_linear, virtual_light.a);
    light_before = vec4(plate_linear, touched ? 1.0 : 0.0);
#ifdef PLATE_SHARE
    plate_share = vec4(kept, 1.0);
#endif
#else
#ifdef GRAIN
    linear = with_grain(linear, plate_linear, kept);
#endif
    composited_code = touched ? vec4(code_from_linear(toned(linear)), 1.0) : vec4(code, 0.0);
#endif
#ifdef REFLECTION_LAYER
    reflection_layer = vec4(mirrored, 0.0);
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
#ifdef MATTE
        // A pixel is of what covers more than half of it.
        if (in_front > 0.5) geometry = object = vec4(0.0);
#endif
    }
#endif
}
