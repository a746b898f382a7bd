// Ways over plate pixels while the shutter is open. Include common/lens_map.glsl before.

uniform float least_motion_px;  // shorter ways are none

// The way in plate pixels of what changes its direction (x/z, y/z) by `change`: by the lens to first order.
vec2 way_of_change(vec2 change, vec2 pixel, vec2 normalized) {
    mat2 normalized_by_pixel = mat2(normalized_from_pixel(pixel + vec2(1.0, 0.0)) - normalized,
                                    normalized_from_pixel(pixel + vec2(0.0, 1.0)) - normalized);
    vec2 way = inverse(normalized_by_pixel) * change;
    bool none = any(isnan(way)) || any(isinf(way)) || dot(way, way) < least_motion_px * least_motion_px;
    return none ? vec2(0.0) : way;
}
