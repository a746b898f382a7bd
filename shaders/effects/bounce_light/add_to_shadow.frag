#version 450 core
// Takes what bounces to the surface off what the shadow's map says is lost there.

uniform sampler2D share;        // of the surface's unshadowed light, over `share_rectangle_m`
uniform vec4 share_rectangle_m; // min x, min y, width, height on the surface
uniform vec4 rectangle_m;       // of the map
uniform vec2 map_size;

layout(location = 0) out vec4 lost;   // added to the map's: rgb = lost, a = 0

void main() {
    vec2 surface_m = rectangle_m.xy + gl_FragCoord.xy / map_size * rectangle_m.zw;
    ivec2 size = textureSize(share, 0);
    vec2 at = (surface_m - share_rectangle_m.xy) / share_rectangle_m.zw * vec2(size) - 0.5;
    lost = vec4(0.0);
    if (any(lessThan(at, vec2(0.0))) || any(greaterThan(at, vec2(size - 1)))) return;
    ivec2 texel = min(ivec2(at), size - 2);
    vec2 t = at - vec2(texel);
    vec4 low = mix(texelFetch(share, texel, 0), texelFetch(share, texel + ivec2(1, 0), 0), t.x);
    vec4 high = mix(texelFetch(share, texel + ivec2(0, 1), 0), texelFetch(share, texel + ivec2(1, 1), 0), t.x);
    lost.rgb = -mix(low, high, t.y).rgb;
}
