#version 450 core
// Takes out of a list of draws the cells that lie wholly behind what was drawn before, or (PEELED) wholly before the layer
// that was peeled off last (Greene, Kass & Miller 1993, "Hierarchical Z-Buffer Visibility").
layout(local_size_x = 64) in;

struct Draw {
    uint count, instances, first, base_instance;
};
layout(std430, binding = 0) buffer Draws { Draw draws[]; };
layout(std430, binding = 1) readonly buffer Boxes { vec4 boxes[]; };  // low, high; one pair a draw

uniform int first_draw, draw_count;
uniform mat4 clip_from_model, clip_from_model_low;  // floats, and (LONG_LENS) what they left of it
uniform vec2 picture_px;
uniform sampler2D pyramid;         // the first level holds the farthest depth of side × side pixels; PEELED: the nearest
uniform int side;
uniform int levels;
uniform ivec2 level_0_size;

#ifdef PEELED
#define chosen max
const float none = 0.0;
#else
#define chosen min
const float none = 1.0;
#endif

float depth_in(ivec2 low, ivec2 high) {
    // A level at which a few texels cover it.
    int level = 0;
    while (level + 1 < levels && any(greaterThan((high >> level) - (low >> level), ivec2(3)))) ++level;
    low >>= level;
    high >>= level;
    float depth = none;
    for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) depth = chosen(depth, texelFetch(pyramid, ivec2(x, y), level).r);
    return depth;
}

void main() {
    int i = int(gl_GlobalInvocationID.x);
    if (i >= draw_count) return;
    i += first_draw;
    vec3 low_m = boxes[2 * i].xyz, high_m = boxes[2 * i + 1].xyz;
    vec2 low = vec2(1.0), high = vec2(-1.0);
    float nearest = 0.0, farthest = 1.0;
    for (int corner = 0; corner < 8; ++corner) {
        vec3 at = mix(low_m, high_m, vec3(corner & 1, (corner >> 1) & 1, corner >> 2));
#ifdef LONG_LENS
        vec4 clip = vec4((dmat4(clip_from_model) + dmat4(clip_from_model_low)) * dvec4(at, 1.0));
#else
        vec4 clip = clip_from_model * vec4(at, 1.0);
#endif
        if (clip.w <= clip.z) return;  // before the near plane: seen
        low = min(low, clip.xy / clip.w);
        high = max(high, clip.xy / clip.w);
        nearest = max(nearest, clip.z / clip.w);
        farthest = min(farthest, clip.z / clip.w);
    }
    // In texels of the first level; a pixel more for rounding.
    vec2 top_left = 0.5 * (vec2(low.x, -high.y) + 1.0) * picture_px, bottom_right = 0.5 * (vec2(high.x, -low.y) + 1.0) * picture_px;
    ivec2 first = clamp(ivec2(floor((top_left - 1.0) / float(side))), ivec2(0), level_0_size - 1);
    ivec2 last = clamp(ivec2(floor((bottom_right + 1.0) / float(side))), ivec2(0), level_0_size - 1);
    const float slack = 1.00001;
#ifdef PEELED
    bool is_passed_over = farthest > slack * depth_in(first, last);
#else
    bool is_passed_over = nearest * slack < depth_in(first, last);
#endif
    if (is_passed_over) {
        draws[i].count = 0u;
        draws[i].instances = 0u;
    }
}
