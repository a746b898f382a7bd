#version 450 core
// The plainest full-screen pass: what effects are measured against.
uniform sampler2D source;

in vec2 uv;
out vec4 color;

void main() { color = texture(source, uv); }
