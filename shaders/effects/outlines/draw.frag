#version 450 core
// Draws an object's edges over it, as wide as they are asked for. The blending leaves coverage as it is.

uniform sampler2D edges;
uniform usampler2D layer_object_id;
uniform uint object_id;
uniform ivec2 picture_size;
uniform float width_px;            // of the layer
uniform vec3 outline_color;        // probe units

#ifdef DEPTH_CUE
#include "surface/depth_cue.glsl"
uniform sampler2D layer_depth_m;
#endif

layout(location = 0) out vec4 line;   // a = how much of the pixel

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    if (texelFetch(layer_object_id, pixel, 0).r != object_id) discard;
    int reach = int(ceil(width_px));
    float nearest = width_px + 1.0;
    for (int y = -reach; y <= reach; ++y) {
        for (int x = -reach; x <= reach; ++x) {
            ivec2 at = pixel + ivec2(x, y);
            if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, picture_size))) continue;
            if (texelFetch(edges, at, 0).r > 0.0) nearest = min(nearest, length(vec2(x, y)));
        }
    }
    // An edge's pixel is the line's first.
    float share = clamp(width_px - nearest, 0.0, 1.0);
    if (share <= 0.0) discard;
    vec3 drawn = outline_color;
#ifdef DEPTH_CUE
    drawn = with_depth_cue(drawn, texelFetch(layer_depth_m, pixel, 0).r);
#endif
    line = vec4(share * drawn, share);
}
