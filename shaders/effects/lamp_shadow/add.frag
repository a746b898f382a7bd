#version 450 core
// Adds the loss by lamps to a shadow's map: in the fine one, which lies over the far one, what that does not say.
#include "effects/contact_shadow/contact_shadow.glsl"

uniform sampler2D lamp_loss;      // over the map
uniform sampler2D coarse_loss;    // over `coarse_rectangle_m`; width 0: none
uniform vec4 coarse_rectangle_m;
uniform vec4 rectangle_m;         // of the map

layout(location = 0) out vec4 lost;

void main() {
    lost = texelFetch(lamp_loss, ivec2(gl_FragCoord.xy), 0);
    if (coarse_rectangle_m.z <= 0.0) return;
    vec2 at = rectangle_m.xy + gl_FragCoord.xy / vec2(textureSize(lamp_loss, 0)) * rectangle_m.zw;
    lost -= shadow_loss(coarse_loss, coarse_rectangle_m, at);
}
