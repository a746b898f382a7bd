// What spheres/meet.glsl needs of a sphere where a pixel is so narrow that floats no longer tell its ray from the next
// one's: by how much the square of the radius is above that of the ray's distance from the centre, as a polynomial about
// the sphere's own place in the picture. Its terms are small there, and floats hold them.
uniform mat4 clip_from_model_low;             // what floats left of clip_from_model
uniform mat3 ray_from_ndc, ray_from_ndc_low;  // as spheres/ray.glsl has it, and what floats left of it

flat out vec2 about_ndc;
flat out vec3 left_linear, left_square;  // of 1, x, y; of x², x·y, y²; over radius²
flat out vec3 along;                     // (eye − centre)·direction: of 1, x, y
flat out float meeting_radius;
flat out float power;                    // |eye − centre|² − radius²

vec4 clip_of(dvec3 from_eye) {
    dvec4 clip = (dmat4(clip_from_model) + dmat4(clip_from_model_low)) * dvec4(from_eye, 0.0);
    return vec4(clip.xy, clip_from_model[3].z, clip.w);
}

void set_meeting(dvec3 from_eye, float radius, vec2 middle) {
    about_ndc = clamp(middle, -1.0, 1.0);
    meeting_radius = radius;
    double square = double(radius) * double(radius);
    power = float(dot(from_eye, from_eye) - square);
    dmat3 rays = dmat3(ray_from_ndc) + dmat3(ray_from_ndc_low);
    dvec3 ray = rays * dvec3(about_ndc, 1.0);
    dvec3 aside = cross(from_eye, ray), aside_x = cross(from_eye, rays[0]), aside_y = cross(from_eye, rays[1]);
    left_linear = vec3(dot(ray, ray) - dot(aside, aside) / square, 2.0 * (dot(ray, rays[0]) - dot(aside, aside_x) / square),
                       2.0 * (dot(ray, rays[1]) - dot(aside, aside_y) / square));
    left_square = vec3(dot(rays[0], rays[0]) - dot(aside_x, aside_x) / square,
                       2.0 * (dot(rays[0], rays[1]) - dot(aside_x, aside_y) / square),
                       dot(rays[1], rays[1]) - dot(aside_y, aside_y) / square);
    along = vec3(-dot(from_eye, ray), -dot(from_eye, rays[0]), -dot(from_eye, rays[1]));
}
