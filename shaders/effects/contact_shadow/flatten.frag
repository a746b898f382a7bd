#version 450 core
// Marks the texels that a caster covers, and how much light it sends back; the colour mask chooses the direction's channel.

uniform float caster_reflectance;   // 0..1

out vec4 covered;                   // 0 = open, ½ = covered by black, 1 = covered by white

void main() { covered = vec4(0.5 + 0.5 * caster_reflectance); }
