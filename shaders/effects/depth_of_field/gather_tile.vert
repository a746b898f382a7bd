#version 450 core
// A quad a tile, where a set of classes reaches it; nothing where none does.

uniform sampler2D reached;        // gather_reach.frag
uniform ivec4 reached_region;
uniform uint wanted_bits;
uniform int quad_texels;          // of the target, along a tile
uniform ivec4 target_region;

void main() {
    ivec2 place = ivec2(gl_InstanceID % reached_region.z, gl_InstanceID / reached_region.z);
    uint bits = uint(texelFetch(reached, place, 0).r);
    ivec2 corner = ivec2(gl_VertexID & 1, gl_VertexID >> 1);
    vec2 texel = vec2((reached_region.xy + place + corner) * quad_texels - target_region.xy);
    // All corners in one point: no area.
    if ((bits & wanted_bits) == 0u) texel = vec2(0.0);
    // Row 0 is at the top of clip space (glClipControl).
    vec2 share = texel / vec2(target_region.zw);
    gl_Position = vec4(2.0 * share.x - 1.0, 1.0 - 2.0 * share.y, 0.0, 1.0);
}
