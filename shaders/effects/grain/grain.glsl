// Noise that makes virtual light as grainy as the plate: see src/render/effects/grain.h. Include common/graph.glsl before.

uniform sampler2D grain_noise;        // RGB of variance 1
uniform ivec4 grain_noise_region;
uniform float grain_read2, grain_shot;
uniform float grain_strength;
uniform float grain_brightest;        // light that saturates the sensor
uniform float grain_least_deviation;  // noise of less is none

vec3 grain_variance(vec3 light) { return grain_read2 + grain_shot * clamp(light, 0.0, grain_brightest); }

// `kept`: the share of the plate's own light, with its noise, that is in `light`. Light never goes below none.
vec3 with_grain(vec3 light, vec3 plate, vec3 kept) {
    vec3 missing = grain_variance(light) - kept * kept * grain_variance(plate);
    vec3 deviation = grain_strength * sqrt(max(missing, 0.0));
    deviation = mix(deviation, vec3(0.0), lessThan(deviation, vec3(grain_least_deviation)));
    vec3 noise = deviation * fetch_or_zero(grain_noise, grain_noise_region, target_texel()).rgb;
    return mix(max(light + noise, 0.0), light, equal(noise, vec3(0.0)));
}
