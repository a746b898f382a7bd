#version 450 core
// A corner of what the window's controls are drawn with.
uniform vec2 window_px;

layout(location = 0) in vec2 position_px;
layout(location = 1) in vec2 corner_uv;
layout(location = 2) in uint packed_color;

out vec2 uv;
out vec4 color;

void main() {
    uv = corner_uv;
    color = unpackUnorm4x8(packed_color);
    gl_Position = vec4(2.0 * position_px.x / window_px.x - 1.0, 1.0 - 2.0 * position_px.y / window_px.y, 0.0, 1.0);
}
