#version 450 core
// The probe as skydome: the mean of the lat-long image over what a pixel, or a texel of several, sees of it.
//
// Taps along the longer axis of the pixel's footprint, at the level of detail of the shorter one (McCormack et al. 1999,
// "Feline: fast elliptical lines for anisotropic texture mapping", with equal weights): near the poles a pixel spans
// many columns and few rows.
#include "common/graph.glsl"
#include "common/mappings.glsl"

uniform sampler2D source;         // lat-long, scene-linear; each level the means over solid angle of the one before
uniform vec4 intrinsics;          // fx, fy, cx, cy
uniform mat3 world_from_camera;
uniform vec3 gain;
uniform int texel_px;             // pixels along a side of what is drawn
uniform int samples;              // along it

layout(location = 0) out vec4 light;

const int most_taps = 16;

vec2 uv_of_pixel(vec2 pixel) {
    return latlong_uv(normalize(world_from_camera * vec3((pixel - intrinsics.zw) / intrinsics.xy, 1.0)));
}

// By hand: hardware weighs with eight bits, which shows around a sun. Wraps in longitude, ends at the poles.
vec3 bilinear(vec2 uv, int level) {
    ivec2 size = max(textureSize(source, 0) >> level, ivec2(1));  // llvmpipe takes one invocation's level for its neighbours'
    vec2 at = uv * vec2(size) - 0.5;
    ivec2 low = ivec2(floor(at));
    vec2 t = at - vec2(low);
    int left = (low.x % size.x + size.x) % size.x;
    int right = left + 1 < size.x ? left + 1 : 0;
    int top = clamp(low.y, 0, size.y - 1);
    int bottom = clamp(low.y + 1, 0, size.y - 1);
    return mix(mix(texelFetch(source, ivec2(left, top), level).rgb, texelFetch(source, ivec2(right, top), level).rgb, t.x),
               mix(texelFetch(source, ivec2(left, bottom), level).rgb, texelFetch(source, ivec2(right, bottom), level).rgb, t.x),
               t.y);
}

vec3 at_level(vec2 uv, float level) {
    int fine = min(int(level), textureQueryLevels(source) - 1);
    int coarse = min(fine + 1, textureQueryLevels(source) - 1);
    float t = clamp(level - float(fine), 0.0, 1.0);
    vec3 radiance = bilinear(uv, fine);
    return t > 0.0 ? mix(radiance, bilinear(uv, coarse), t) : radiance;
}

// The way from one place to another, the short way around in longitude.
vec2 step_between(vec2 from, vec2 to) {
    vec2 way = to - from;
    way.x -= round(way.x);
    return way;
}

// Over a square of `side` pixels.
vec3 mean_light(vec2 pixel, float side) {
    vec2 uv = uv_of_pixel(pixel);
    vec2 size = vec2(textureSize(source, 0));
    vec2 along_x = step_between(uv, uv_of_pixel(pixel + vec2(side, 0.0)));
    vec2 along_y = step_between(uv, uv_of_pixel(pixel + vec2(0.0, side)));
    float x_texels = length(along_x * size), y_texels = length(along_y * size);
    bool x_is_longer = x_texels > y_texels;
    vec2 along = x_is_longer ? along_x : along_y;
    vec2 across = x_is_longer ? along_y : along_x;
    float longer = max(x_texels, y_texels), shorter = min(x_texels, y_texels);
    if (longer <= 1.0) return bilinear(uv, 0);
    int taps = int(min(ceil(longer / max(shorter, 1.0)), float(most_taps)));
    float level = log2(max(longer / float(taps), 1.0));
    // Three taps for every texel of the level, both ways: then hardly any light falls between them.
    const int density = 3;
    int count = density * taps;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < density * count; ++i) {
        float a = (float(i / density) + 0.5) / float(count) - 0.5;
        float b = (float(i % density) + 0.5) / float(density) - 0.5;
        sum += at_level(uv + a * along + b * across, level);
    }
    return sum / float(density * count);
}

void main() {
    vec2 texel = vec2(target_texel());
    float side = float(texel_px) / float(samples);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < samples * samples; ++i) {
        vec2 within = (vec2(i % samples, i / samples) + 0.5) * side;
        sum += mean_light(texel * float(texel_px) + within - 0.5, side);
    }
    light = vec4(sum / float(samples * samples) * gain, 0.0);
}
