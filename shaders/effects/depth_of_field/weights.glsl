// What a sample gives to a pixel: overlap · intensity · leakage control, over the sum of all weights (Zhou, Chen & Pullen
// 2007, "Accurate Depth of Field Simulation in Real Time"). Include common/graph.glsl before.
//
// Deviations: the circle's rim is centred on its radius, so that circles are as wide as they should be; leakage is
// relative to the sample's circle, so that it does not depend on the picture's size; and where nothing virtual is, the
// plate counts, which is behind everything and stays as it is.

uniform sampler2D light;          // premultiplied, coverage
uniform ivec4 light_region;
uniform sampler2D circles;        // x = signed circle, y > 0 where something is
uniform ivec4 circles_region;
uniform ivec4 circles_frame;
uniform float largest_radius_px;
uniform float least_coc_px;       // narrower is in focus

// 1/r² diverges in focus: a pixel is no smaller than itself.
float radius_of(float circle_px) { return clamp(0.5 * abs(circle_px), 0.5, largest_radius_px); }

float overlap(float radius, float away) { return clamp(radius - away + 0.5, 0.0, 1.0); }

float intensity(float radius) { return 1.0 / (radius * radius); }

// Light from behind passes by a surface as far as the lens sees around it: not at all where that is in focus.
float leakage(vec2 own, float circle_px) {
    if (own.y == 0.0 || circle_px <= own.x) return 1.0;
    if (abs(own.x) < least_coc_px) return 0.0;
    float share = radius_of(own.x) / radius_of(circle_px);
    return min(share * share, 1.0);
}

struct Gathered {
    vec4 light;
    float weight;
    float plate;      // weight of places where nothing virtual is, as seen from a pixel that is covered
    float radius;     // these two times weight
    float circle_px;
};

// A sample that stands for `area` places, `away` from the pixel, whose own circle is `own`.
void take(inout Gathered sum, vec2 own, ivec2 texel, float away, float area) {
    vec2 circle = fetch_or_zero(circles, circles_region, texel).xy;
    if (circle.y == 0.0) {
        float radius = radius_of(own.x);
        sum.plate += own.y * area * overlap(radius, away) * intensity(radius);
        return;
    }
    float radius = radius_of(circle.x);
    float covers = overlap(radius, away);
    if (covers == 0.0) return;
    float weight = area * covers * intensity(radius) * leakage(own, circle.x);
    sum.light += weight * fetch_or_zero(light, light_region, texel);
    sum.weight += weight;
    sum.radius += weight * radius;
    sum.circle_px += weight * circle.x;
}

// What light that falls where nothing is goes on with: the mean of the circles it came from.
vec2 handed_on(Gathered sum) {
    if (sum.weight == 0.0) return vec2(0.0);
    return vec2(2.0 * (sum.circle_px < 0.0 ? -1.0 : 1.0) * sum.radius / sum.weight, 1.0);
}
