// Which pixels show a sphere that their neighbours do not.
uniform usampler2D seen_spheres;
uniform ivec2 size_px;

// Nearest first.
const ivec2 around[9] = ivec2[](ivec2(0, 0), ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1), ivec2(1, 1), ivec2(-1, 1),
                                ivec2(1, -1), ivec2(-1, -1));

ivec2 neighbour(ivec2 pixel, int which) { return clamp(pixel + around[which], ivec2(0), size_px - 1); }

bool is_at_edge(ivec2 pixel, uint id) {
    for (int i = 1; i < 9; ++i)
        if (texelFetch(seen_spheres, neighbour(pixel, i), 0).r != id) return true;
    return false;
}
