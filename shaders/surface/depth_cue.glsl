// What is virtual fades to a colour with its distance along the camera's z (depth cueing, as PHIGS and OpenGL's linear fog
// have it).
uniform vec3 depth_cue_color;      // probe units
uniform vec2 depth_cue_range_m;    // from where, and to where
uniform float depth_cue_strength;  // share of the colour there

vec3 with_depth_cue(vec3 radiance, float z_m) {
    float way = clamp((z_m - depth_cue_range_m.x) / (depth_cue_range_m.y - depth_cue_range_m.x), 0.0, 1.0);
    return mix(radiance, depth_cue_color, way * depth_cue_strength);
}
