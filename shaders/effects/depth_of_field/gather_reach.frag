#version 450 core
// Which classes of circles reach a tile along one axis: both axes in turn make the square around it.

#include "common/graph.glsl"
#include "effects/depth_of_field/circles.glsl"

uniform usampler2D classes;     // gather_mask.frag, or what reaches along the other axis
uniform ivec4 classes_region;
uniform ivec2 axis;             // (1, 0) or (0, 1)
uniform int tile_px;
uniform int farthest_tiles;     // of the widest class
uniform float first_reach_px;   // of the narrowest class; each reaches twice as far as the one before

layout(location = 0) out uint reached;

void main() {
    ivec2 place = target_texel() - classes_region.xy;
    int along = axis.x * place.x + axis.y * place.y;
    int last = axis.x * classes_region.z + axis.y * classes_region.w - 1;
    uint found = 0u;
    for (int step = -min(farthest_tiles, along); step <= min(farthest_tiles, last - along); ++step) {
        uint there = texelFetch(classes, place + step * axis, 0).r;
        // From edge to edge. The classes that reach so far are the outermost bits on both sides.
        float apart_px = float(max(abs(step) - 1, 0) * tile_px);
        int narrowest = 1 + max(int(ceil(log2(apart_px / first_reach_px))), 0);
        uint wide = (1u << max(class_count - narrowest + 1, 0)) - 1u;
        found |= there & (step == 0 ? ~0u : apart_px > 0.0 ? wide | (wide << (class_count + narrowest)) : ~bit_of(0));
    }
    reached = found;
}
