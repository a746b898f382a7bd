#version 450 core
// Where the fragment is, and which draw it belongs to.
uniform float mark;
in vec2 uv;
layout(location = 0) out vec4 color;

void main() {
    color = vec4(uv, gl_FragCoord.y, mark);
}
