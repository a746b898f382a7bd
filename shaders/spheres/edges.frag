#version 450 core
// Pixels at the edges of spheres take the light of all that they show, each in the share of the pixel that it covers.
#include "spheres/neighbours.glsl"

uniform sampler2D seen_depth;   // near_m / z of the sphere, also where something else is drawn before it
uniform sampler2D drawn_depth;  // near_m / z of what is drawn, 0 where nothing is
uniform sampler2D outlines;     // spheres/outline.frag
uniform mat3 camera_from_ndc;
uniform int side;  // places along a pixel's side
uniform float near_m;

uniform sampler2D before_0;
layout(location = 0) out vec4 after_0;
#if PICTURES > 1
uniform sampler2D before_1;
layout(location = 1) out vec4 after_1;
#endif
#if PICTURES > 2
uniform sampler2D before_2;
layout(location = 2) out vec4 after_2;
#endif

const float nowhere = 1e38;

// Where a ray (1 along the camera's z) meets a sphere, along the camera's z; `nowhere` where it passes by. Both forms of
// what is left of the square of the sine say the same; each keeps its digits where the other loses them.
float nearest_z_m(vec4 outline, vec3 ray) {
    if (outline.w < 0.0) return 0.9 * nowhere;  // the far side of what is all around
    float away = length(outline.xyz);
    vec3 towards = outline.xyz / away;
    float along = dot(towards, ray);
    float cosine = inversesqrt(1.0 + outline.w * outline.w), sine = outline.w * cosine, square = dot(ray, ray);
    vec3 aside = cross(towards, ray);
    float left = sine < 0.7 ? sine * sine * square - dot(aside, aside) : along * along - cosine * cosine * square;
    if (left < 0.0 || along <= 0.0) return nowhere;
    return away * cosine * cosine / (along + sqrt(left));
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint own_id = texelFetch(seen_spheres, pixel, 0).r;
    if (!is_at_edge(pixel, own_id)) discard;

    // What is seen here and around: spheres, and (of the pixels that show none) what is behind them.
    vec4 outline[9];
    uint ids[9];
    ivec2 shown_at[9];
    int shown = 0;
    float own_depth = texelFetch(drawn_depth, pixel, 0).r;
    const float same = 1.0 + 1e-5;
    bool shows_sphere = own_id != 0u && own_depth <= same * texelFetch(seen_depth, pixel, 0).r;
    if (own_id != 0u && !shows_sphere) discard;  // something else is before them
    ivec2 behind_at[9];
    int behind = 0;
    if (!shows_sphere) behind_at[behind++] = pixel;
    for (int i = 0; i < 9; ++i) {
        ivec2 at = neighbour(pixel, i);
        uint id = texelFetch(seen_spheres, at, 0).r;
        float depth = texelFetch(drawn_depth, at, 0).r;
        if (id == 0u) {
            if (shows_sphere && depth < own_depth) behind_at[behind++] = at;
            continue;
        }
        if (depth > same * texelFetch(seen_depth, at, 0).r) continue;
        bool known = false;
        for (int k = 0; k < shown; ++k) known = known || ids[k] == id;
        if (known) continue;
        ids[shown] = id;
        shown_at[shown] = at;
        outline[shown++] = texelFetch(outlines, at, 0);
    }
    if (shown == 0) discard;

    float own_z_m = shows_sphere || own_depth <= 0.0 ? nowhere : near_m / own_depth;
    int counts[9] = int[](0, 0, 0, 0, 0, 0, 0, 0, 0);
    int uncovered = 0;
    vec2 first = gl_FragCoord.xy - 0.5 + 0.5 / float(side);
    for (int row = 0; row < side; ++row) {
        for (int column = 0; column < side; ++column) {
            vec2 place = first + vec2(column, row) / float(side);
            vec2 ndc = vec2(2.0, -2.0) * place / vec2(size_px) + vec2(-1.0, 1.0);
            vec3 ray = camera_from_ndc * vec3(ndc, 1.0);
            float nearest = own_z_m;
            int which = -1;
            for (int k = 0; k < shown; ++k) {
                float z_m = nearest_z_m(outline[k], ray);
                if (z_m < nearest) {
                    nearest = z_m;
                    which = k;
                }
            }
            if (which < 0) ++uncovered;
            else ++counts[which];
        }
    }
    // Between spheres whose neighbours are spheres there is another that no pixel's middle shows: those that do, stand
    // for it.
    int total = side * side - (behind == 0 ? uncovered : 0);
    vec4 sum_0 = vec4(0.0);
#if PICTURES > 1
    vec4 sum_1 = vec4(0.0);
#endif
#if PICTURES > 2
    vec4 sum_2 = vec4(0.0);
#endif
    int parts = shown + behind;
    for (int i = 0; i < parts; ++i) {
        bool is_sphere = i < shown;
        float share = is_sphere ? float(counts[i]) / float(total) : float(uncovered) / float(total * behind);
        if (share <= 0.0) continue;
        ivec2 at = is_sphere ? shown_at[i] : behind_at[i - shown];
        sum_0 += share * texelFetch(before_0, at, 0);
#if PICTURES > 1
        sum_1 += share * texelFetch(before_1, at, 0);
#endif
#if PICTURES > 2
        sum_2 += share * texelFetch(before_2, at, 0);
#endif
    }
    after_0 = sum_0;
#if PICTURES > 1
    after_1 = sum_1;
#endif
#if PICTURES > 2
    after_2 = sum_2;
#endif
}
