// The virtual layer over plate pixels. Include common/lens_map.glsl before.

// Where the lens does not bend, a plate pixel is as many whole layer pixels along a side; 0: it is not so.
#ifndef LAYER_DENSITY
#define LAYER_DENSITY 0
#endif

uniform sampler2D layer;             // premultiplied radiance in probe units, alpha = coverage
uniform vec4 layer_intrinsics;       // fx, fy, cx, cy of the layer's pinhole, in its pixels (centres at whole numbers)
uniform ivec2 layer_size;            // the part of the texture that was drawn
uniform int layer_present;
uniform ivec2 layer_first_pixel;     // the plate pixel at the layer's corner, with LAYER_DENSITY

// A direction's place in the layer, counted from the corner of its first pixel.
vec2 layer_position(vec2 normalized) { return normalized * layer_intrinsics.xy + layer_intrinsics.zw + 0.5; }

// The layer's pixels that one plate pixel spans: the lens bends, so it is more in one place than in another.
vec2 layer_footprint(vec2 pixel, vec2 normalized) {
    vec2 next = normalized_from_pixel(pixel + 1.0);
    vec2 footprint = abs(next - normalized) * layer_intrinsics.xy;
    return any(isnan(footprint)) ? vec2(1.0) : clamp(footprint, 1.0, 16.0);
}

// The layer's light over one plate pixel in the direction `normalized`: the exact mean over its footprint.
vec4 layer_over_pixel(ivec2 pixel, vec2 normalized) {
    vec4 sum = vec4(0.0);
#if LAYER_DENSITY > 0
    ivec2 first = (pixel - layer_first_pixel) * LAYER_DENSITY;
    if (any(lessThan(first, ivec2(0))) || any(greaterThanEqual(first, layer_size))) return sum;
    for (int y = 0; y < LAYER_DENSITY; ++y)
        for (int x = 0; x < LAYER_DENSITY; ++x) sum += texelFetch(layer, first + ivec2(x, y), 0);
    return sum / float(LAYER_DENSITY * LAYER_DENSITY);
#else
    // An upright box in the layer.
    vec2 footprint = layer_footprint(vec2(pixel), normalized);
    vec2 centre = layer_position(normalized);
    vec2 low = centre - 0.5 * footprint;
    vec2 high = centre + 0.5 * footprint;
    ivec2 first = max(ivec2(floor(low)), ivec2(0));
    ivec2 last = min(ivec2(ceil(high)), layer_size) - 1;
    for (int y = first.y; y <= last.y; ++y) {
        float height = min(high.y, float(y + 1)) - max(low.y, float(y));
        for (int x = first.x; x <= last.x; ++x) {
            float width = min(high.x, float(x + 1)) - max(low.x, float(x));
            sum += width * height * texelFetch(layer, ivec2(x, y), 0);
        }
    }
    return sum / (footprint.x * footprint.y);
#endif
}
