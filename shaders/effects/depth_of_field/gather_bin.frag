#version 450 core
// The layer's points of one class of circles, each texel as its light times the share that one texel of its disc takes.

#include "common/graph.glsl"
#include "common/lens_map.glsl"
#include "composite/layer.glsl"
#include "effects/depth_of_field/fragments.glsl"

uniform sampler2D classes;      // gather_mask.frag
uniform ivec4 classes_region;
uniform int tile_px;
uniform int class_count;
uniform int own_class;
uniform int texel_px;           // plate pixels along a texel
uniform sampler2D kernels;      // R: radius of the drawn disc, G: 1 / its texels; by the circle's radius in texels
uniform float kernel_step;      // texels from entry to entry
uniform int kernel_row;

layout(location = 0) out vec4 light_share;  // premultiplied light and coverage, over the disc's texels
layout(location = 1) out vec2 disc;         // r: radius of the disc in texels, 0 where there is none; g: coverage of all
                                            // that the texel shows, whatever its class

void main() {
    ivec2 texel = target_texel();
    light_share = vec4(0.0);
    disc = vec2(0.0);
    vec2 corner = vec2(texel * texel_px) - 0.5;
    ivec2 first_tile = ivec2(floor(vec2(texel * texel_px) / float(tile_px)));
    ivec2 last_tile = ivec2(floor(vec2((texel + 1) * texel_px - 1) / float(tile_px)));
    uint found = 0u;
    for (int y = first_tile.y; y <= last_tile.y; ++y)
        for (int x = first_tile.x; x <= last_tile.x; ++x)
            found |= uint(fetch_or_zero(classes, classes_region, ivec2(x, y)).r);
    if (found == 0u) return;
    bool has_own = (found & (1u << (own_class + class_count))) != 0u;

    vec2 low = layer_position(normalized_beyond(corner));
    vec2 high = layer_position(normalized_beyond(corner + float(texel_px)));
    if (any(isnan(low)) || any(isnan(high))) return;
    vec2 span = high - low;
    ivec2 first = max(ivec2(floor(low)), ivec2(0));
    ivec2 last = min(ivec2(ceil(high)), layer_size) - 1;
    vec4 sum = vec4(0.0);
    float coverage = 0.0, widths = 0.0, weights = 0.0;
    for (int y = first.y; y <= last.y; ++y) {
        float height = min(high.y, float(y + 1)) - max(low.y, float(y));
        for (int x = first.x; x <= last.x; ++x) {
            float area = height * (min(high.x, float(x + 1)) - max(low.x, float(x)));
            vec4 seen = texelFetch(layer, ivec2(x, y), 0);
            coverage += area * seen.a;
            float depth_share = texelFetch(layer_depth_share, ivec2(x, y), 0).r;
            if (!has_own || depth_share == 0.0) continue;
            float coc_px = signed_coc_px(depth_share);
            if (class_of(coc_px) == own_class) {
                sum += area * seen;
                widths += area * abs(coc_px);
                weights += area;
                // What is behind it blurs as it does: together they would count twice.
                continue;
            }
            if (hidden_present == 0) continue;
            depth_share = texelFetch(hidden_depth_share, ivec2(x, y), 0).r;
            if (depth_share == 0.0) continue;
            coc_px = signed_coc_px(depth_share);
            if (class_of(coc_px) != own_class) continue;
            sum += area * texelFetch(hidden_layer, ivec2(x, y), 0);
            widths += area * abs(coc_px);
            weights += area;
        }
    }
    float whole = span.x * span.y;
    disc.g = coverage / whole;
    if (weights <= 0.0) return;
    // Where the lens magnifies, discs are as much larger.
    float magnification = layer_density * float(texel_px) / sqrt(whole);
    float radius = 0.5 * widths / weights * magnification / float(texel_px);
    float place = clamp(radius / kernel_step, 0.0, float(textureSize(kernels, 0).x - 1));
    int entry = min(int(place), textureSize(kernels, 0).x - 2);
    vec2 kernel = mix(texelFetch(kernels, ivec2(entry, kernel_row), 0).rg,
                      texelFetch(kernels, ivec2(entry + 1, kernel_row), 0).rg, place - float(entry));
    disc.r = kernel.r;
    light_share = sum / whole * kernel.g;
}
