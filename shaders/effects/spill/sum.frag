#version 450 core
// One effect's light, brought to the resolution at which the effects are summed.
#include "common/graph.glsl"

uniform sampler2D source;
uniform ivec4 source_region, source_frame;
uniform int source_scale;
uniform int target_scale;

layout(location = 0) out vec4 light;

void main() {
    vec2 position = (vec2(target_texel()) + 0.5) * float(target_scale) / float(source_scale) - 0.5;
    light = vec4(linear_in_frame(source, source_region, source_frame, position).rgb, 0.0);
}
