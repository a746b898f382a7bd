#version 450 core
// A model's vertices where they are at mid-exposure, and before the camera when the shutter opens and closes.
layout(location = 0) in vec3 position;  // metres, the model's own axes
layout(location = 3) in vec2 texture_uv;
layout(location = 4) in vec4 color;
layout(location = 7) in vec3 opening_position;  // of vertices that move against each other
layout(location = 8) in vec3 closing_position;

uniform mat4 clip_from_model;  // multiplied in double precision on the CPU, as the two below
uniform mat4 opening_camera_from_model, closing_camera_from_model;
uniform bool deforms;

out vec3 opening_m, closing_m;  // camera axes
out vec2 material_uv;
out vec4 vertex_color;

void main() {
    opening_m = (opening_camera_from_model * vec4(deforms ? opening_position : position, 1.0)).xyz;
    closing_m = (closing_camera_from_model * vec4(deforms ? closing_position : position, 1.0)).xyz;
    material_uv = texture_uv;
    vertex_color = color;
    gl_Position = clip_from_model * vec4(position, 1.0);
}
