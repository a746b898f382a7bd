#version 450 core
// Marks the texels that a caster covers; the colour mask chooses the direction's channel.

out vec4 covered;

void main() { covered = vec4(1.0); }
