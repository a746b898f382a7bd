#version 450 core
// The farthest depth of side × side texels, or (NEAREST) the nearest, for the next level of a pyramid (Greene, Kass &
// Miller 1993, "Hierarchical Z-Buffer Visibility").
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D finer;
uniform ivec2 finer_size;
uniform int finer_level;
uniform int side;
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
    if (any(greaterThanEqual(texel, (finer_size + side - 1) / side))) return;
    ivec2 first = side * texel;
    float depth = at(first);
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) depth = chosen(depth, at(first + ivec2(x, y)));
    imageStore(coarser, texel, vec4(depth));
}
