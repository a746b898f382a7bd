#version 450 core
// The farthest depth of four texels, or (NEAREST) the nearest, for the next level of a pyramid (Greene, Kass & Miller 1993,
// "Hierarchical Z-Buffer Visibility").
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D finer;
uniform ivec2 finer_size;
uniform int finer_level;
layout(r32f, binding = 0) writeonly uniform image2D coarser;

#ifdef NEAREST
#define chosen max
// Nearest of all is what spheres/finished.frag wrote: no layer.
float depth_of(float stored) { return stored >= 1.0 ? 0.0 : stored; }
#else
#define chosen min
float depth_of(float stored) { return stored; }
#endif

float at(ivec2 texel) { return depth_of(texelFetch(finer, min(texel, finer_size - 1), finer_level).r); }

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, (finer_size + 1) / 2))) return;
    ivec2 first = 2 * texel;
    float depth = chosen(chosen(at(first), at(first + ivec2(1, 0))), chosen(at(first + ivec2(0, 1)), at(first + ivec2(1, 1))));
    imageStore(coarser, texel, vec4(depth));
}
