#version 450 core
// Takes what bounces to the surface off what the shadow's map says is lost there.

#include "effects/contact_shadow/contact_shadow.glsl"

uniform sampler2D share;        // of the surface's unshadowed light, over `share_rectangle_m`
uniform vec4 share_rectangle_m; // min x, min y, width, height on the surface
uniform vec4 rectangle_m;       // of the map
uniform vec2 map_size;

layout(location = 0) out vec4 lost;   // added to the map's: rgb = lost, a = 0

void main() {
    vec2 surface_m = rectangle_m.xy + gl_FragCoord.xy / map_size * rectangle_m.zw;
    // What is a share here is a loss there.
    lost = vec4(-shadow_loss(share, share_rectangle_m, surface_m).rgb, 0.0);
}
