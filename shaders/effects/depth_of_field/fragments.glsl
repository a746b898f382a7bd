// What the layer shows of each point, and how wide it becomes. Include common/lens_map.glsl and composite/layer.glsl
// before.

uniform sampler2D layer_depth_share;    // near_m / z, 0 where nothing is
uniform sampler2D hidden_layer;         // what is behind the nearest surface, as `layer`
uniform sampler2D hidden_depth_share;
uniform int hidden_present;
uniform float near_m;

uniform float coc_scale_px_m;
uniform float focus_per_m;              // 1 / focus distance
uniform float largest_coc_px;           // wider ones are taken as this
uniform float least_coc_px;             // narrower ones are none
uniform float first_class_px;           // classes double from here
uniform float layer_density;            // layer pixels along a plate pixel that the lens does not bend
uniform vec2 frame_px;                  // the plate's size

// Diameter in plate pixels, negative before the focus (calibration/thin_lens.h).
float signed_coc_px(float depth_share) {
    return clamp(coc_scale_px_m * (focus_per_m - depth_share / near_m), -largest_coc_px, largest_coc_px);
}

// 0: sharp; ±1: narrower than first_class_px; ±2: up to twice that; ±3: up to four times …
int class_of(float coc_px) {
    float width = abs(coc_px);
    if (width < least_coc_px) return 0;
    int size = width < first_class_px ? 1 : 2 + int(floor(log2(width / first_class_px)));
    return coc_px < 0.0 ? -size : size;
}

// As normalized_from_pixel; beyond the frame the lens goes on straight.
vec2 normalized_beyond(vec2 pixel) {
    vec2 inside = clamp(pixel, vec2(0.0), frame_px - 1.0);
    vec2 normalized = normalized_from_pixel(inside);
    if (inside == pixel) return normalized;
    vec2 along_x = normalized_from_pixel(inside + vec2(1.0, 0.0)) - normalized;
    vec2 along_y = normalized_from_pixel(inside + vec2(0.0, 1.0)) - normalized;
    vec2 beyond = pixel - inside;
    return normalized + beyond.x * along_x + beyond.y * along_y;
}
