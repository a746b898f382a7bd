#version 450 core
// What surfaces see of the environment in every direction, as a lat-long picture: what a report compares.
#include "common/environment.glsl"

uniform vec2 picture_size;
uniform float roughness;
uniform int from_sphere_map;

layout(location = 0) out vec4 radiance;

void main() {
    vec2 share = gl_FragCoord.xy / picture_size;
    // Row 0 is straight up, the middle column looks along +y, columns run to +x.
    float azimuth = (share.x - 0.5) * 2.0 * pi;
    float polar = share.y * pi;
    vec3 direction = vec3(sin(polar) * sin(azimuth), sin(polar) * cos(azimuth), cos(polar));
    radiance = from_sphere_map != 0 ? texture(environment_sphere_map, sphere_map_uv(direction))
                                    : vec4(reflected_radiance(direction, roughness), 1.0);
}
