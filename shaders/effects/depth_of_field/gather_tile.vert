#version 450 core
// A quad a tile, where a class of circles reaches it; nothing where it does not.

uniform usampler2D reached;       // gather_reach.frag
uniform ivec4 reached_region;
uniform uint wanted_bit;
uniform int wanted_company;       // 0: wherever the class is; 1: where it is alone; 2: where others reach, too
uniform int quad_texels;          // of the target, along a tile
uniform ivec4 target_region;

flat out int is_last_of_tile;     // nothing farther reaches it
flat out int follows_next;        // the next nearer class reaches it, too

void main() {
    ivec2 place = ivec2(gl_InstanceID % reached_region.z, gl_InstanceID / reached_region.z);
    uint bits = texelFetch(reached, place, 0).r;
    ivec2 corner = ivec2(gl_VertexID & 1, gl_VertexID >> 1);
    vec2 texel = vec2((reached_region.xy + place + corner) * quad_texels - target_region.xy);
    bool wanted = (bits & wanted_bit) != 0u && (wanted_company == 0 || (bits == wanted_bit) == (wanted_company == 1));
    // All corners in one point: no area.
    if (!wanted) texel = vec2(0.0);
    // Classes are bits from the nearest to the farthest.
    is_last_of_tile = bits < 2u * wanted_bit ? 1 : 0;
    follows_next = (bits & (wanted_bit >> 1)) != 0u ? 1 : 0;
    // Row 0 is at the top of clip space (glClipControl).
    vec2 share = texel / vec2(target_region.zw);
    gl_Position = vec4(2.0 * share.x - 1.0, 1.0 - 2.0 * share.y, 0.0, 1.0);
}
