// Undistorted direction of a plate pixel, from the grid that compositor/lens_map.cpp makes.

uniform sampler2D lens_nodes;    // RG = (x/z, y/z) at every lens_spacing-th pixel, first node at (−spacing, −spacing)
uniform float lens_spacing;

// NaN where the lens model does not reach the pixel. Beyond the grid its outermost cells go on straight.
vec2 normalized_from_pixel(vec2 pixel) {
    vec2 at = pixel / lens_spacing + 1.0;
    ivec2 node = clamp(ivec2(floor(at)), ivec2(0), textureSize(lens_nodes, 0) - 2);
    vec2 t = at - vec2(node);
    vec2 top = mix(texelFetch(lens_nodes, node, 0).rg, texelFetch(lens_nodes, node + ivec2(1, 0), 0).rg, t.x);
    vec2 bottom = mix(texelFetch(lens_nodes, node + ivec2(0, 1), 0).rg, texelFetch(lens_nodes, node + ivec2(1, 1), 0).rg, t.x);
    return mix(top, bottom, t.y);
}
