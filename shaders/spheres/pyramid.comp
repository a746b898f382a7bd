#version 450 core
// The farthest depth of four texels, for the next level of a pyramid (Greene, Kass & Miller 1993, "Hierarchical Z-Buffer
// Visibility").
layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D finer;
uniform ivec2 finer_size;
uniform int finer_level;
layout(r32f, binding = 0) writeonly uniform image2D coarser;

float at(ivec2 texel) { return texelFetch(finer, min(texel, finer_size - 1), finer_level).r; }

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, (finer_size + 1) / 2))) return;
    ivec2 first = 2 * texel;
    float farthest = min(min(at(first), at(first + ivec2(1, 0))), min(at(first + ivec2(0, 1)), at(first + ivec2(1, 1))));
    imageStore(coarser, texel, vec4(farthest));
}
