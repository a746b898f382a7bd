#version 450 core
// Adds up the light that four directions lose to the casters, as shares of the surface's unshadowed irradiance.

uniform sampler2D masks;         // one direction a channel: coverage 0..1
uniform vec3 lost_share[4];      // RGB share of the irradiance that each direction brings

layout(location = 0) out vec4 lost;

void main() {
    vec4 mask = texelFetch(masks, ivec2(gl_FragCoord.xy), 0);
    lost = vec4(mask.r * lost_share[0] + mask.g * lost_share[1] + mask.b * lost_share[2] + mask.a * lost_share[3], 0.0);
}
