// Textures of the render graph: each holds a region of the frame; what lies outside of it is dark.
uniform ivec4 target_region;  // x, y, width, height of what the pass writes, in texels of its scale

// The texel that this invocation writes, counted from the frame's corner at the pass's scale.
ivec2 target_texel() { return ivec2(gl_FragCoord.xy) + target_region.xy; }

// `region` is the uniform that goes with the sampler (NAME_region); `texel` counts from the frame's corner.
vec4 fetch_or_zero(sampler2D source, ivec4 region, ivec2 texel) {
    ivec2 place = texel - region.xy;
    return any(lessThan(place, ivec2(0))) || any(greaterThanEqual(place, region.zw)) ? vec4(0.0) : texelFetch(source, place, 0);
}

// Bilinear between texel centres (at whole numbers), in full float precision.
vec4 linear_or_zero(sampler2D source, ivec4 region, vec2 position) {
    ivec2 low = ivec2(floor(position));
    vec2 t = position - vec2(low);
    return mix(mix(fetch_or_zero(source, region, low), fetch_or_zero(source, region, low + ivec2(1, 0)), t.x),
               mix(fetch_or_zero(source, region, low + ivec2(0, 1)), fetch_or_zero(source, region, low + ivec2(1, 1)), t.x), t.y);
}

// The same in a frame (the uniform NAME_frame): where the region ends at the frame's edge its outermost texels go on to
// that edge; elsewhere it fades to dark.
vec4 linear_in_frame(sampler2D source, ivec4 region, ivec4 frame, vec2 position) {
    vec2 low = vec2(min(frame.xy, region.xy));
    vec2 high = vec2(max(frame.xy + frame.zw, region.xy + region.zw) - 1);
    return linear_or_zero(source, region, clamp(position, low, high));
}
