// The circle of confusion of the real surface. Include common/lens_map.glsl and composite/shadow.glsl before.

uniform float coc_scale_px_m;
uniform float focus_per_m;      // 1 / focus distance
uniform float focal_px;         // of a lens that bends nothing
uniform float largest_coc_px;   // wider ones are taken as this
uniform float least_coc_px;     // narrower ones are none
uniform float class_texels;     // circles of class k are from class_texels to 2 · class_texels wide, in texels of 2^k px
uniform int least_class;        // where the shadow is smooth narrower circles are of this class, too

struct SurfaceCircle {
    float coc_px;  // signed, negative before the focus; NaN where the lens model does not reach
    vec2 change;   // of it, a pixel to the right and down
};

// Inverse depth is affine in x/z and y/z on a plane, and goes on beyond its horizon: what is seen past the rim of a wide
// lens there.
float surface_coc_px(vec2 normalized) {
    float per_m = (world_from_camera * vec3(normalized, 1.0)).z / (surface_z_m - eye_world_m.z);
    return coc_scale_px_m * (focus_per_m - per_m);
}

SurfaceCircle surface_circle(vec2 pixel) {
    vec2 normalized = normalized_from_pixel(pixel);
    vec2 right = normalized_from_pixel(pixel + vec2(1.0, 0.0));
    vec2 below = normalized_from_pixel(pixel + vec2(0.0, 1.0));
    float magnification = 1.0 / (focal_px * sqrt(abs(determinant(mat2(right - normalized, below - normalized)))));
    float coc_px = magnification * surface_coc_px(normalized);
    if (abs(coc_px) > largest_coc_px) return SurfaceCircle(sign(coc_px) * largest_coc_px, vec2(0.0));
    return SurfaceCircle(coc_px, magnification * vec2(surface_coc_px(right), surface_coc_px(below)) - coc_px);
}

int surface_class(float width_px) {
    return max(width_px < 2.0 * class_texels ? 0 : int(floor(log2(width_px / class_texels))), least_class);
}
