#version 450 core
// Marks the texels that a caster covers, and how much light it sends back; the colour mask chooses the direction's channel.

uniform float caster_reflectance;   // 0..1

#ifdef SPHERES
#include "spheres/meet.glsl"
uniform float surface_depth = 0.5;  // of parallel light
#endif

out vec4 covered;                   // 0 = open, ½ = covered by black, 1 = covered by white

void main() {
#ifdef SPHERES
    // What lies under the surface casts nothing on it.
    if (meet_depth() < surface_depth) discard;
#endif
    covered = vec4(0.5 + 0.5 * caster_reflectance);
}
