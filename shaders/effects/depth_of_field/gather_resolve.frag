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
                                        // coverage of all that is seen; a: 1 where something is sharp

// Diameter in plate pixels, negative before the focus (calibration/thin_lens.h).
float signed_coc_px(float depth_share) {
    return clamp(coc_scale_px_m * (focus_per_m - depth_share / near_m), -largest_coc_px, largest_coc_px);
}

#if LAYER_DENSITY == 0
// As normalized_from_pixel; beyond the frame the lens goes on straight.
vec2 normalized_beyond(vec2 pixel, vec2 inside) {
    vec2 normalized = normalized_from_pixel(inside);
    if (inside == pixel) return normalized;
    vec2 along_x = normalized_from_pixel(inside + vec2(1.0, 0.0)) - normalized;
    vec2 along_y = normalized_from_pixel(inside + vec2(0.0, 1.0)) - normalized;
    vec2 beyond = pixel - inside;
    return normalized + beyond.x * along_x + beyond.y * along_y;
}
#endif

// A mean circle as the lens magnifies it: never so narrow that it would count as sharp after all.
float drawn_circle(float widths, float weights, float magnification) {
    if (weights <= 0.0) return 0.0;
    float width = widths / weights;
    return sign(width) * max(abs(width) * magnification, least_coc_px);
}

// Of what lets light through it comes times the coverage.
float depth_share_at(ivec2 texel) {
    float depth_share = texelFetch(layer_depth_share, texel, 0).r;
#ifdef TRANSPARENT
    float covered = texelFetch(layer, texel, 0).a;
    if (covered > 0.0) depth_share /= covered;
#endif
    return depth_share;
}

#ifdef HIDDEN
// Circles of about the same width on the same side.
bool blur_alike(float one_px, float other_px) {
    if (class_of(one_px) == class_of(other_px)) return true;
    vec2 widths = abs(vec2(one_px, other_px));
    return one_px * other_px > 0.0 && max(widths.x, widths.y) < 2.0 * min(widths.x, widths.y);
}

// Whether what a surface hides would mix with what is seen beside, as if it lay there, too: they blur alike, and what is
// seen is rather the surface's own than what is hidden.
bool mixes(float hidden_px, float surface_px, float beside_px) {
    return blur_alike(hidden_px, beside_px) && abs(beside_px - surface_px) <= abs(beside_px - hidden_px);
}

// The same of what is seen within reach of the hidden disc, where the surface goes over into the next class.
bool mixes_around(float hidden_px, float surface_px, ivec2 texel) {
    if (abs(class_of(hidden_px) - class_of(surface_px)) != 1) return false;
    int reach = int(ceil((0.5 * abs(hidden_px) + 1.0) * layer_density));
    for (int i = 0; i < 4; ++i) {
        ivec2 there = texel + reach * ivec2(i == 0 ? 1 : i == 1 ? -1 : 0, i == 2 ? 1 : i == 3 ? -1 : 0);
        float depth_share = texelFetch(layer_depth_share, clamp(there, ivec2(0), layer_size - 1), 0).r;
        if (depth_share != 0.0 && mixes(hidden_px, surface_px, signed_coc_px(depth_share))) return true;
    }
    return false;
}
#endif

// Sums over the plate pixel; of the circles x of front, y of back.
vec2 widths = vec2(0.0), weights = vec2(0.0);
float coverage = 0.0;

// Adds light of which `share` is blurred; from circles of `between` px on it is behind.
void add_light(vec4 light, float share, float coc_px, float between) {
    if (is_sharp(coc_px)) {
        sharp += light;
    } else if (coc_px <= between) {
        front += light;
        widths.x += share * coc_px;
        weights.x += share;
    } else {
        back += light;
        widths.y += share * coc_px;
        weights.y += share;
    }
}

// Adds a layer pixel, of which the plate pixel takes `share`, among the circles of `range`.
void add_layer_pixel(ivec2 texel, float share, float depth_share, vec2 range, float between) {
    vec4 seen = share * texelFetch(layer, texel, 0);
    // Without a depth it is a surface that lets light through, over nothing else.
    float coc_px = depth_share == 0.0 ? 0.0 : signed_coc_px(depth_share);
    coverage += seen.a;
    add_light(seen, share, coc_px, between);
#ifdef HIDDEN
    float hidden_share = texelFetch(hidden_depth_share, texel, 0).r;
    float hidden_px = signed_coc_px(hidden_share);
    if (hidden_share == 0.0 || mixes(hidden_px, coc_px, range.x) || mixes(hidden_px, coc_px, range.y) ||
        mixes_around(hidden_px, coc_px, texel))
        return;
    // Behind what is seen, however they blur.
    add_light(share * texelFetch(hidden_layer, texel, 0), share, hidden_px, -2.0 * largest_coc_px);
#endif
}

// The least and the greatest circle of what has a depth.
void extend(inout vec2 range, float depth_share) {
    if (depth_share != 0.0) {
        float coc_px = signed_coc_px(depth_share);
        range = vec2(min(range.x, coc_px), max(range.y, coc_px));
    }
}

// Two surfaces meet in the pixel where circles differ by more than one surface's would.
float between_surfaces(vec2 range) { return range.y - range.x > 1.0 ? 0.5 * (range.x + range.y) : largest_coc_px; }

void main() {
    sharp = front = back = circles = vec4(0.0);
    if (layer_present == 0) return;
    vec2 range = vec2(largest_coc_px, -largest_coc_px);
#if LAYER_DENSITY > 0
    ivec2 first = (target_texel() - layer_first_pixel) * LAYER_DENSITY;
    if (any(lessThan(first, ivec2(0))) || any(greaterThanEqual(first, layer_size))) return;
    const int count = LAYER_DENSITY * LAYER_DENSITY;
    float depth_shares[count];
    for (int i = 0; i < count; ++i) {
        depth_shares[i] = depth_share_at(first + ivec2(i % LAYER_DENSITY, i / LAYER_DENSITY));
        extend(range, depth_shares[i]);
    }
    float between = between_surfaces(range);
    for (int i = 0; i < count; ++i)
        add_layer_pixel(first + ivec2(i % LAYER_DENSITY, i / LAYER_DENSITY), 1.0, depth_shares[i], range, between);
    float whole = float(count);
#else
    vec2 pixel = vec2(target_texel());
    vec2 inside = clamp(pixel, vec2(0.0), frame_px - 1.0);
    vec2 normalized = normalized_beyond(pixel, inside);
    if (any(isnan(normalized))) return;
    vec2 footprint = layer_footprint(inside, normalized_from_pixel(inside));
    vec2 centre = layer_position(normalized);
    vec2 low = centre - 0.5 * footprint;
    vec2 high = centre + 0.5 * footprint;
    ivec2 first = max(ivec2(floor(low)), ivec2(0));
    ivec2 last = min(ivec2(ceil(high)), layer_size) - 1;
    for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x)
            extend(range, depth_share_at(ivec2(x, y)));
    float between = between_surfaces(range);
    for (int y = first.y; y <= last.y; ++y) {
        float height = min(high.y, float(y + 1)) - max(low.y, float(y));
        for (int x = first.x; x <= last.x; ++x) {
            float width = min(high.x, float(x + 1)) - max(low.x, float(x));
            float depth_share = depth_share_at(ivec2(x, y));
            add_layer_pixel(ivec2(x, y), width * height, depth_share, range, between);
        }
    }
    float whole = footprint.x * footprint.y;
#endif
    sharp /= whole;
    front /= whole;
    back /= whole;
    // Where the lens magnifies, discs are as much larger.
    float magnification = layer_density / sqrt(whole);
    circles = vec4(drawn_circle(widths.x, weights.x, magnification), drawn_circle(widths.y, weights.y, magnification),
                   coverage / whole, sharp == vec4(0.0) ? 0.0 : 1.0);
}
