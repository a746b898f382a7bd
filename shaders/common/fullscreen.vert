#version 450 core
// One triangle that covers the viewport, drawn without attributes (FullScreenTriangle). `uv` is (0, 0) at the top-left
// corner of the viewport and (1, 1) at its bottom right, as texture coordinates are.
out vec2 uv;

void main() {
    uv = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
    gl_Position = vec4(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 0.0, 1.0);
}
