// What a fragment shows of a model: what its vertices tell, or (SPHERES) what the pixel sees of a set of spheres. Each
// shader that includes it begins with see().
#ifdef SPHERES
#include "spheres/seen.glsl"
#else
in vec3 world_position;
in vec3 world_normal;
in vec4 world_tangent;
in vec2 material_uv;
in vec4 vertex_color;

#define front_facing gl_FrontFacing

#ifdef RELIEF
#include "surface/relief.glsl"
#else
bool see() { return true; }
float inverse_z() { return gl_FragCoord.w; }  // clip-space w is the camera's z
#endif
#endif
