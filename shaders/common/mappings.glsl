// Between world directions (z up) and places on the images of the light, as in lighting/probe.h.

const float pi = 3.14159265358979;

// Lat-long: (0, 0) is the top-left corner; the top looks straight up, the middle along world +y, +x lies right of it.
vec2 latlong_uv(vec3 direction) {
    // atan(0, 0) is undefined in GLSL: straight up and down, where every longitude is the same place.
    float longitude = dot(direction.xy, direction.xy) > 0.0 ? atan(direction.x, direction.y) : 0.0;
    // The angle from straight up; acos is less exact, most of all near the poles.
    return vec2(0.5 + longitude / (2.0 * pi), atan(length(direction.xy), direction.z) / pi);
}

// Direction of a place on a cube face, uv in [0, 1]² with row 0 first (OpenGL 4.5, table 8.19). Not normalised.
vec3 cube_direction(int face, vec2 uv) {
    vec2 st = 2.0 * uv - 1.0;
    if (face == 0) return vec3(1.0, -st.y, -st.x);
    if (face == 1) return vec3(-1.0, -st.y, st.x);
    if (face == 2) return vec3(st.x, 1.0, st.y);
    if (face == 3) return vec3(st.x, -1.0, -st.y);
    if (face == 4) return vec3(st.x, -st.y, 1.0);
    return vec3(-st.x, -st.y, -1.0);
}

// The sphere map's own axes: x right, y up, z out of its middle, which looks along world +y as mirror-ball images do.
vec3 sphere_map_from_world(vec3 direction) {
    return direction.xzy;
}

// The classic lookup (OpenGL 1.x, GL_SPHERE_MAP): m = 2·sqrt(rx² + ry² + (rz + 1)²), (s, t) = (rx, ry)/m + ½; here with
// t downwards, as image rows run. All of the rim is the one direction r = (0, 0, −1), where m = 0: 1 + rz is floored,
// which moves only directions nearer than 0.0015 rad to that pole.
vec2 sphere_map_uv(vec3 world_direction) {
    vec3 r = sphere_map_from_world(world_direction);
    const float smallest = 1e-6;
    float m = 2.0 * sqrt(r.x * r.x + r.y * r.y + pow(max(r.z + 1.0, smallest), 2.0));
    return vec2(0.5 + r.x / m, 0.5 - r.y / m);
}

// World direction of a place on the sphere map; outside of the disc the pole that its whole rim is.
vec3 sphere_map_direction(vec2 uv) {
    vec2 n = vec2(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y);
    float radius2 = dot(n, n);
    if (radius2 >= 1.0) return vec3(0.0, -1.0, 0.0);
    float nz = sqrt(1.0 - radius2);
    vec3 r = vec3(2.0 * nz * n, 2.0 * nz * nz - 1.0);
    return r.xzy;
}
