#version 450 core
// Enough arithmetic to be measured.
in vec2 uv;
layout(location = 0) out vec4 color;

void main() {
    vec2 z = uv;
    for (int i = 0; i < 32; ++i) z = vec2(z.x * z.x - z.y * z.y, 2.0 * z.x * z.y) * 0.5 + uv;
    color = vec4(z, 0.0, 1.0);
}
