#version 450 core
// The layer on plate pixels, sorted by what becomes of it: sharp, and up to two surfaces out of focus.

#include "common/graph.glsl"
#include "common/lens_map.glsl"
#include "composite/layer.glsl"
#include "effects/depth_of_field/circles.glsl"

uniform sampler2D layer_depth_share;    // near_m / z, 0 where nothing is
uniform sampler2D hidden_layer;         // what is behind the nearest surface, as `layer`
uniform sampler2D hidden_depth_share;
uniform float near_m;
uniform float coc_scale_px_m;
uniform float focus_per_m;              // 1 / focus distance
uniform float largest_coc_px;           // wider ones are taken as this
uniform float layer_density;            // layer pixels along a plate pixel that the lens does not bend
uniform vec2 frame_px;                  // the plate's size

layout(location = 0) out vec4 sharp;    // premultiplied light and coverage, each
layout(location = 1) out vec4 front;
layout(location = 2) out vec4 back;     // behind the front one, seen or hidden
layout(location = 3) out vec4 circles;  // signed diameters in plate pixels of front and back, 0 where there is none; b:
                                        // coverage of all that is seen

// Diameter in plate pixels, negative before the focus (calibration/thin_lens.h).
float signed_coc_px(float depth_share) {
    return clamp(coc_scale_px_m * (focus_per_m - depth_share / near_m), -largest_coc_px, largest_coc_px);
}

// As normalized_from_pixel; beyond the frame the lens goes on straight.
vec2 normalized_beyond(vec2 pixel, vec2 inside) {
    vec2 normalized = normalized_from_pixel(inside);
    if (inside == pixel) return normalized;
    vec2 along_x = normalized_from_pixel(inside + vec2(1.0, 0.0)) - normalized;
    vec2 along_y = normalized_from_pixel(inside + vec2(0.0, 1.0)) - normalized;
    vec2 beyond = pixel - inside;
    return normalized + beyond.x * along_x + beyond.y * along_y;
}

// A mean circle as the lens magnifies it: never so narrow that it would count as sharp after all.
float drawn_circle(float widths, float weights, float magnification) {
    if (weights <= 0.0) return 0.0;
    float width = widths / weights;
    return sign(width) * max(abs(width) * magnification, least_coc_px);
}

void main() {
    vec2 pixel = vec2(target_texel());
    sharp = front = back = circles = vec4(0.0);
    vec2 inside = clamp(pixel, vec2(0.0), frame_px - 1.0);
    vec2 normalized = normalized_beyond(pixel, inside);
    if (any(isnan(normalized)) || layer_present == 0) return;
    vec2 footprint = layer_footprint(inside, normalized_from_pixel(inside));
    vec2 centre = layer_position(normalized);
    vec2 low = centre - 0.5 * footprint;
    vec2 high = centre + 0.5 * footprint;
    ivec2 first = max(ivec2(floor(low)), ivec2(0));
    ivec2 last = min(ivec2(ceil(high)), layer_size) - 1;

    float nearest = largest_coc_px, farthest = -largest_coc_px;
    for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
            float depth_share = texelFetch(layer_depth_share, ivec2(x, y), 0).r;
            if (depth_share == 0.0) continue;
            float coc_px = signed_coc_px(depth_share);
            nearest = min(nearest, coc_px);
            farthest = max(farthest, coc_px);
        }
    }
    // Two surfaces meet in the pixel where circles differ by more than one surface's would.
    float between = farthest - nearest > 1.0 ? 0.5 * (nearest + farthest) : largest_coc_px;
    vec2 widths = vec2(0.0), weights = vec2(0.0);
    vec4 hidden_sharp = vec4(0.0);
    float coverage = 0.0;
    for (int y = first.y; y <= last.y; ++y) {
        float height = min(high.y, float(y + 1)) - max(low.y, float(y));
        for (int x = first.x; x <= last.x; ++x) {
            float width = min(high.x, float(x + 1)) - max(low.x, float(x));
            vec4 seen = texelFetch(layer, ivec2(x, y), 0);
            coverage += width * height * seen.a;
            float depth_share = texelFetch(layer_depth_share, ivec2(x, y), 0).r;
            float coc_px = signed_coc_px(depth_share);
            // Without a depth it is a surface that lets light through, over nothing else.
            if (depth_share == 0.0 || is_sharp(coc_px)) {
                sharp += width * height * seen;
            } else if (coc_px <= between) {
                front += width * height * seen;
                widths.x += width * height * coc_px;
                weights.x += width * height;
            } else {
                back += width * height * seen;
                widths.y += width * height * coc_px;
                weights.y += width * height;
            }
#ifdef HIDDEN
            float hidden_share = texelFetch(hidden_depth_share, ivec2(x, y), 0).r;
            float hidden_px = signed_coc_px(hidden_share);
            // What blurs as the surface before it would count twice together with it.
            if (hidden_share == 0.0 || class_of(hidden_px) == class_of(coc_px)) continue;
            vec4 hidden = width * height * texelFetch(hidden_layer, ivec2(x, y), 0);
            if (is_sharp(hidden_px)) {
                hidden_sharp += hidden;
            } else {
                back += hidden;
                widths.y += width * height * hidden_px;
                weights.y += width * height;
            }
#endif
        }
    }
    // Where a surface comes into focus within the pixel, what is behind it would take the place of its sharp part.
    if (sharp.a == 0.0) sharp += hidden_sharp;
    float whole = footprint.x * footprint.y;
    sharp /= whole;
    front /= whole;
    back /= whole;
    // Where the lens magnifies, discs are as much larger.
    float magnification = layer_density / sqrt(whole);
    circles = vec4(drawn_circle(widths.x, weights.x, magnification), drawn_circle(widths.y, weights.y, magnification),
                   coverage / whole, 0.0);
}
