#version 450 core
// What the window's controls are drawn with: a colour times a texture, code values as they are.
uniform sampler2D glyphs;

in vec2 uv;
in vec4 color;
layout(location = 0) out vec4 shown;

void main() {
    shown = color * texture(glyphs, uv);
}
