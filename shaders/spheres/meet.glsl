// Where a pixel's ray meets the sphere that spheres/sphere.vert placed there.
#include "spheres/ray.glsl"

#ifdef LONG_LENS
flat in vec2 about_ndc;  // spheres/long_lens.glsl
flat in vec3 left_linear, left_square, along;
flat in float meeting_radius;
#else
flat in vec4 seen_sphere;
#endif
flat in float power;
flat in uint sphere_id;

#ifdef PARALLEL
uniform vec3 depth_from_model;  // of clip space

// Of the near side and the far side, larger is nearer, or less than 0 where the ray passes by.
vec2 meet_depths() {
    vec2 aside = picture_ndc() - seen_sphere.xy;
    vec3 from_centre = ray_from_ndc[0] * aside.x + ray_from_ndc[1] * aside.y;
    float left2 = seen_sphere.w * seen_sphere.w - dot(from_centre, from_centre);
    if (!(left2 >= 0.0)) return vec2(-1.0);
    float half_chord = sqrt(left2);
    float middle = seen_sphere.z + dot(depth_from_model, from_centre);
    float half_depth = dot(depth_from_model, ray_from_ndc[2]) * half_chord;
    return vec2(middle - half_depth, middle + half_depth);
}

float meet_depth() { return meet_depths().x; }
#else
// The same, as the depth buffer has it.
float meet_depth() {
#ifdef LONG_LENS
    vec2 ndc = picture_ndc(), aside = ndc - about_ndc;
    vec3 direction = ray_direction(ndc), step = vec3(1.0, aside);
    float left = dot(left_linear, step) + dot(left_square, vec3(aside.x * aside, aside.y * aside.y));
    if (!(left >= 0.0)) return -1.0;
    float z_m = nearest_by_root(dot(direction, direction), dot(along, step), power, meeting_radius * sqrt(left));
#else
    vec3 direction = ray_direction(picture_ndc());
    float z_m = nearest_on_sphere(seen_sphere, power, direction);
#endif
    return z_m < 0.0 ? -1.0 : near_plane_m / z_m;
}
#endif
