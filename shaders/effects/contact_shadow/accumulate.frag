#version 450 core
// Adds up what four directions lose to the casters and what the casters send back instead, as shares of the surface's
// unshadowed irradiance.

uniform sampler2D masks;         // one direction a channel, as flatten.frag marks them
uniform vec3 lost_share[4];      // RGB share of the irradiance that each direction brings
uniform vec4 returned_share;     // what a white caster there sends back of the surface's own light, as such a share

layout(location = 0) out vec4 lost;   // rgb = lost, a = returned

void main() {
    vec4 mask = texelFetch(masks, ivec2(gl_FragCoord.xy), 0);
    vec4 covered = step(0.25, mask);
    vec4 reflectance = clamp(2.0 * mask - 1.0, 0.0, 1.0);
    lost.rgb = covered.r * lost_share[0] + covered.g * lost_share[1] + covered.b * lost_share[2] + covered.a * lost_share[3];
    lost.a = dot(covered * reflectance, returned_share);
}
