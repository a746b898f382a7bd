#version 450 core
// Adds up what the surface loses to casters of four points of a lamp, as shares of what the shadow's maps are shares of.
#include "common/lamps.glsl"

uniform sampler2D masks;         // one point a channel, as contact_shadow/flatten.frag marks them
uniform int lamp;
uniform float point_share;       // of the lamp's light that comes from each
uniform vec4 rectangle_m;        // of the map: min x, min y, width, height
uniform float lamp_surface_z_m;
uniform vec3 inverse_reference;

layout(location = 0) out vec4 lost;   // a = 0

void main() {
    vec4 mask = texelFetch(masks, ivec2(gl_FragCoord.xy), 0);
    float covered = dot(step(0.25, mask), vec4(point_share));
    vec2 at = rectangle_m.xy + gl_FragCoord.xy / vec2(textureSize(masks, 0)) * rectangle_m.zw;
    LampLight light = lamp_light(lamps[lamp], vec3(at, lamp_surface_z_m));
    lost = vec4(covered * max(light.to_lamp.z, 0.0) * light.irradiance * inverse_reference, 0.0);
}
