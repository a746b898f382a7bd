#version 450 core
// The picture of the real surface at one place.
#include "common/surface_picture.glsl"
uniform vec2 xy_m;
uniform float footprint_m;
layout(location = 0) out vec4 seen;
void main() { seen = surface_picture(xy_m, footprint_m); }
