#version 450 core
// How far the footage's own things are, as depth that hides what is virtual behind them. Each sample for itself, so that
// edges are as smooth as those of shapes.
//
// Between four pixels of one surface 1/z is interpolated, which is exact for planes. Where an edge runs between them
// nothing is halfway: the depth is their median, weighted as in interpolation. Whatever lies between the near and the
// far side is then hidden where the near pixels weigh more than half: along a line through the middles between pixels,
// not along their sides.

sample in vec2 plate_position;

uniform sampler2D real_inverse_depth;  // 1/m, one texel a plate pixel; 0 where it is not known
uniform float near_m;
uniform float nearness;                // of 1/z, 1 but where shapes are to win
#ifdef HIDDEN
uniform sampler2D nearest_depth_share;
#endif

#ifdef WAYS
layout(location = 0) out vec4 way;     // as effects/motion_blur/ways.frag
#elif !defined(HIDDEN) && !defined(DEPTH_ALONE)
layout(location = 0) out vec4 color;   // as surface/holdout.frag
#ifdef LENS
layout(location = 1) out vec4 focus_share;
#endif
#ifdef COVERAGE
layout(location = COVERAGE) out vec4 coverage;
#endif
#endif

float at(ivec2 pixel) {
    return texelFetch(real_inverse_depth, clamp(pixel, ivec2(0), textureSize(real_inverse_depth, 0) - 1), 0).r;
}

// Depths closer together than a share of them are one surface whatever is beside: sensors are not more exact.
const float depth_noise = 0.01;

// Whether four depths in a row lie on one surface: the step in the middle is no edge if the surface goes on as steep on
// either side.
bool is_one_surface(vec4 row) {
    if (row.y == 0.0 || row.z == 0.0) return false;
    float middle = abs(row.z - row.y);
    float before = abs(row.y - row.x), after = abs(row.w - row.z);
    float beside = row.x == 0.0 ? after : row.w == 0.0 ? before : min(before, after);
    return middle <= max(2.0 * beside, depth_noise * max(row.y, row.z));
}

float median_of(vec4 depths, vec4 weights) {
    // The greatest depth that those at least as great weigh half with.
    float found = 0.0;
    for (int i = 0; i < 4; ++i) {
        float as_near = dot(weights, vec4(greaterThanEqual(depths, vec4(depths[i]))));
        if (as_near >= 0.5) found = max(found, depths[i]);
    }
    return found;
}

float inverse_depth_at(vec2 position) {
    ivec2 low = ivec2(floor(position));
    vec2 t = position - vec2(low);
    vec4 depths = vec4(at(low), at(low + ivec2(1, 0)), at(low + ivec2(0, 1)), at(low + ivec2(1, 1)));
    bool is_smooth = is_one_surface(vec4(at(low - ivec2(1, 0)), depths.x, depths.y, at(low + ivec2(2, 0)))) &&
                     is_one_surface(vec4(at(low + ivec2(-1, 1)), depths.z, depths.w, at(low + ivec2(2, 1)))) &&
                     is_one_surface(vec4(at(low - ivec2(0, 1)), depths.x, depths.z, at(low + ivec2(0, 2)))) &&
                     is_one_surface(vec4(at(low + ivec2(1, -1)), depths.y, depths.w, at(low + ivec2(1, 2))));
    vec4 weights = vec4((1.0 - t.x) * (1.0 - t.y), t.x * (1.0 - t.y), (1.0 - t.x) * t.y, t.x * t.y);
    return is_smooth ? dot(depths, weights) : median_of(depths, weights);
}

void main() {
    float inverse = inverse_depth_at(plate_position) * nearness;
    float share = near_m * inverse;
    if (share <= 0.0) discard;
#ifdef HIDDEN
    const float same = 1.0 - 1e-5;
    if (share >= same * texelFetch(nearest_depth_share, ivec2(gl_FragCoord.xy), 0).r) discard;
#endif
    gl_FragDepth = min(share, 1.0);
#ifdef WAYS
    way = vec4(0.0, 0.0, 65535.0, inverse);  // no object's number; how it moves is not known
#elif !defined(HIDDEN) && !defined(DEPTH_ALONE)
    const vec4 covered = vec4(0.0, 0.0, 0.0, 1.0);
    color = covered;
#ifdef LENS
    focus_share = vec4(gl_FragDepth, 0.0, 0.0, 1.0);
#endif
#ifdef COVERAGE
    coverage = covered;
#endif
#endif
}
