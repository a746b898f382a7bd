#version 450 core
// Marks pixels at which an object has an edge: where the next pixel is another thing behind it, or its own surface farther
// off, or turned another way (Saito & Takahashi 1990, "Comprehensible Rendering of 3-D Shapes").

uniform sampler2D layer_depth_m;    // along the camera's z; 0: nothing
uniform sampler2D layer_normal;     // world
uniform usampler2D layer_object_id;
uniform ivec2 picture_size;
uniform mat3 world_from_pixel;      // × (pixel, 1): the ray, one metre along the camera's z

layout(location = 0) out float edge;  // 1: there is one

// Between neighbours the surface falls away more steeply than this over its own slope: a jump.
const float steepest_tangent = 4.0;
const float least_crease_cosine = 0.866;  // 30°

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint id = texelFetch(layer_object_id, pixel, 0).r;
    edge = 0.0;
    if (id == 0u) return;
    float z_m = texelFetch(layer_depth_m, pixel, 0).r;
    vec3 n = texelFetch(layer_normal, pixel, 0).xyz;
    vec3 ray = world_from_pixel * vec3(gl_FragCoord.xy, 1.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 way = ivec2(i < 2 ? 2 * i - 1 : 0, i < 2 ? 0 : 2 * i - 5);
        ivec2 next = pixel + way;
        if (any(lessThan(next, ivec2(0))) || any(greaterThanEqual(next, picture_size))) continue;
        uint next_id = texelFetch(layer_object_id, next, 0).r;
        float next_z_m = texelFetch(layer_depth_m, next, 0).r;
        if (next_id != id) {
            if (next_id == 0u || next_z_m > z_m) edge = 1.0;
            continue;
        }
        // Where the plane of this pixel is in the next one; seen edge on it is nowhere.
        vec3 step = world_from_pixel * vec3(way, 0.0);
        float facing = dot(n, ray + step);
        float plane_z_m = abs(facing) > 1e-6 ? z_m * dot(n, ray) / facing : z_m;
        float farther = next_z_m - max(plane_z_m, z_m);
        if (farther > steepest_tangent * z_m * length(step)) edge = 1.0;
        if (dot(n, texelFetch(layer_normal, next, 0).xyz) < least_crease_cosine) edge = 1.0;
    }
}
