#version 450 core
// What is kept of casters that are seen from both sides at once: the height towards either.

layout(location = 0) out vec2 heights;

void main() { heights = vec2(gl_FragCoord.z, 1.0 - gl_FragCoord.z); }
