#version 450 core
// The plate as a grid of the lens' cells, each where a view without distortion has it.

uniform sampler2D lens_nodes;    // as in common/lens_map.glsl
uniform float lens_spacing;
uniform ivec2 first_cell;
uniform int cells_across;
uniform mat4 clip_from_camera;

sample out vec2 plate_position;

void main() {
    ivec2 node = first_cell + ivec2(gl_InstanceID % cells_across, gl_InstanceID / cells_across) +
                 ivec2(gl_VertexID & 1, gl_VertexID >> 1);
    plate_position = (vec2(node) - 1.0) * lens_spacing;
    vec2 normalized = texelFetch(lens_nodes, node, 0).rg;
    // Where the lens model does not reach there is nothing: all its corners behind the camera.
    gl_Position = any(isnan(normalized)) ? vec4(0.0, 0.0, 0.0, -1.0) : clip_from_camera * vec4(normalized, 1.0, 1.0);
    // Depth is each fragment's own.
    gl_Position.z = 0.5 * gl_Position.w;
}
