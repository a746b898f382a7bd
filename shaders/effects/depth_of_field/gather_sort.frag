#version 450 core
// The surfaces of one class of circles, each texel as its light times the share that one texel of its disc takes.

#include "common/graph.glsl"
#include "effects/depth_of_field/circles.glsl"

uniform sampler2D front;        // gather_resolve.frag, all over one region
uniform sampler2D back;
uniform sampler2D circles;
uniform ivec4 circles_region;
uniform int own_class;
#ifdef TEXEL_PX
const int texel_px = TEXEL_PX;
#else
uniform int texel_px;           // plate pixels along a texel
#endif
uniform sampler2D kernels;      // R: radius of the drawn disc, G: its texels; by the circle's radius in texels
uniform float kernel_step;      // texels from entry to entry
uniform int kernel_row;

layout(location = 0) out vec4 light_share;  // premultiplied light and coverage, over the disc's texels
layout(location = 1) out vec3 disc;         // r: radius of the disc in texels, 0 where there is none; coverage of what the
                                            // texel shows, g: whatever its class, b: of classes next to its own

// Sums over the texel.
vec4 sum = vec4(0.0);
float coverage = 0.0, next_coverage = 0.0, widths = 0.0, weights = 0.0;

// Adds a surface out of focus; returns the coverage that is left of `rest`.
float add_surface(float coc_px, vec4 light, float rest) {
    int away = abs(class_of(coc_px) - own_class);
    if (coc_px == 0.0) return rest;
    // A surface may cross from one class into the next.
    if (away <= 1) next_coverage += light.a;
    if (away == 0) {
        sum += light;
        widths += light.a * abs(coc_px);
        weights += light.a;
    }
    return rest - light.a;
}

void main() {
    ivec2 corner = target_texel() * texel_px - circles_region.xy;
    for (int y = 0; y < texel_px; ++y) {
        for (int x = 0; x < texel_px; ++x) {
            ivec2 pixel = corner + ivec2(x, y);
            vec3 seen = fetch_or_zero(circles, ivec4(0, 0, circles_region.zw), pixel).rgb;
            coverage += seen.b;
            float rest = add_surface(seen.r, texelFetch(front, pixel, 0), seen.b);
            rest = add_surface(seen.g, texelFetch(back, pixel, 0), rest);
            if (abs(own_class) == 1) next_coverage += max(rest, 0.0);
        }
    }
    float whole = float(texel_px * texel_px);
    light_share = vec4(0.0);
    disc = vec3(0.0, vec2(coverage, min(next_coverage, coverage)) / whole);
    if (weights <= 0.0) return;
    float radius = 0.5 * widths / weights / float(texel_px);
    float place = clamp(radius / kernel_step, 0.0, float(textureSize(kernels, 0).x - 1));
    int entry = min(int(place), textureSize(kernels, 0).x - 2);
    vec2 kernel = mix(texelFetch(kernels, ivec2(entry, kernel_row), 0).rg,
                      texelFetch(kernels, ivec2(entry + 1, kernel_row), 0).rg, place - float(entry));
    disc.r = kernel.r;
    light_share = sum / (whole * kernel.g);
}
