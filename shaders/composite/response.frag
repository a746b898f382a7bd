#version 450 core
// Light becomes code values: what the objects left of the plate, and what bright light spills on it.
//
// picture = light + Σ strength · effect (the study's equation 9), in linear light, before the camera's response. Where
// neither an object nor a visible amount of spilled light is, the plate's own code stays.

#include "common/graph.glsl"
#include "common/response.glsl"
#include "effects/exposure/tone_curve.glsl"
#ifdef GRAIN
#include "effects/grain/grain.glsl"

uniform sampler2D plate_share;   // of the plate's own light in `light_after`
uniform int plate_share_present;
#endif

uniform sampler2D plate_code;    // RGB code values of the region
uniform sampler2D light_after;   // plate-linear; a = the objects' coverage
uniform sampler2D light_before;  // a = 1 where objects touched the pixel
uniform sampler2D spill;         // plate-linear light to add, signed
uniform ivec4 spill_region, spill_frame;
uniform int spill_scale;
uniform int spill_present;
uniform float least_visible_code;   // spilled light that moves no code by this much is none
uniform float least_visible_light;  // less light than this moves none by that much

layout(location = 0) out vec4 composited_code;    // a = 1 where the pixel was touched
#ifdef WRITE_LAYERS
layout(location = 1) out vec4 composited_linear;  // a = the objects' coverage
layout(location = 2) out vec4 spilled_linear;     // what spilled light changed
#endif

void main() {
    ivec2 in_region = ivec2(gl_FragCoord.xy);
    vec3 code = texelFetch(plate_code, in_region, 0).rgb;
#ifdef PLATE_ALONE
    vec4 after = vec4(linear_from_code(code), 0.0);
    bool touched = false;
#else
    vec4 after = texelFetch(light_after, in_region, 0);
    bool touched = texelFetch(light_before, in_region, 0).a > 0.0;
#endif
    vec3 linear = after.rgb;
    bool lit = false;
    if (spill_present != 0) {
        vec2 position = (vec2(target_texel()) + 0.5) / float(spill_scale) - 0.5;
        vec3 spilled = linear_in_frame(spill, spill_region, spill_frame, position).rgb;
        lit = any(notEqual(spilled, vec3(0.0))) && (touched || any(greaterThanEqual(abs(spilled), vec3(least_visible_light))));
        // Spilled shade leaves no less than nothing; colours beyond Rec.709's are below it by themselves.
        if (lit) linear = max(linear + spilled, min(linear, vec3(0.0)));
    }
    if (!touched && !lit) {
        composited_code = vec4(code, 0.0);
#ifdef WRITE_LAYERS
        composited_linear = after;
        spilled_linear = vec4(0.0);
#endif
        return;
    }
#ifdef WRITE_LAYERS
    vec3 before_grain = linear;
#endif
#ifdef GRAIN
    // Whether spilled light is seen is a matter of its own, not of the noise that comes with it.
    vec3 grainless = linear;
#ifdef PLATE_ALONE
    vec3 plate = after.rgb;
#else
    vec3 plate = texelFetch(light_before, in_region, 0).rgb;
#endif
    linear = with_grain(linear, plate, plate_share_present != 0 ? texelFetch(plate_share, in_region, 0).rgb : vec3(1.0));
    vec3 seen = code_from_linear(toned(grainless));
    vec3 shown = code_from_linear(toned(linear));
#else
    vec3 shown = code_from_linear(toned(linear));
    vec3 seen = shown;
#endif
    // Codes beyond the response's ends (footage of limited range has them) are as bright as the ends.
    vec3 moved = abs(seen - clamp(code, 0.0, 1.0));
    touched = touched || any(greaterThanEqual(moved, vec3(least_visible_code)));
    composited_code = touched ? vec4(shown, 1.0) : vec4(code, 0.0);
#ifdef WRITE_LAYERS
    composited_linear = vec4(touched ? linear : after.rgb, after.a);
    spilled_linear = vec4(touched ? before_grain - after.rgb : vec3(0.0), 0.0);
#endif
}
