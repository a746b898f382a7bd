// Colours as hue, saturation and value, and as luma and chroma.

// Hue in sixths of a turn from red, saturation, value. Smith 1978, "Color gamut transform pairs". Grey has the hue 0.
vec3 hsv_from_rgb(vec3 rgb) {
    float value = max(max(rgb.r, rgb.g), rgb.b), least = min(min(rgb.r, rgb.g), rgb.b);
    float range = value - least;
    if (range <= 0.0) return vec3(0.0, 0.0, value);
    float hue = rgb.r == value   ? (rgb.g - rgb.b) / range
                : rgb.g == value ? 2.0 + (rgb.b - rgb.r) / range
                                 : 4.0 + (rgb.r - rgb.g) / range;
    return vec3(hue < 0.0 ? hue + 6.0 : hue, value == 0.0 ? 0.0 : range / value, value);
}

vec3 rgb_from_hsv(vec3 hsv) {
    vec3 ramps = clamp(abs(mod(hsv.x + vec3(0.0, 4.0, 2.0), 6.0) - 3.0) - 1.0, 0.0, 1.0);
    return hsv.z * mix(vec3(1.0), ramps, hsv.y);
}

// NTSC 1953 (FCC 73.682): luma, in-phase and quadrature chroma; and its exact inverse.
const mat3 yiq_from_rgb = transpose(mat3(0.299, 0.587, 0.114,               //
                                         0.595716, -0.274453, -0.321263,    //
                                         0.211456, -0.522591, 0.311135));
const mat3 rgb_from_yiq = transpose(mat3(1.0, 0.95629572, 0.62102442,       //
                                         1.0, -0.2721221, -0.6473806,       //
                                         1.0, -1.10698902, 1.704615));
