// Directions about a normal, spread evenly.

// Points that fill the unit square evenly, however many are taken (Roberts 2018, "The Unreasonable Effectiveness of
// Quasirandom Sequences": R2), as 32-bit fractions, so that none is lost to rounding.
vec2 spread_point(uint index, uvec2 start) {
    uvec2 place = start + index * uvec2(3242174889u, 2447445414u);   // 2^32 / 1.3247…, 2^32 / 1.3247…²
    return vec2(place) * (1.0 / 4294967296.0);
}

// Points of the unit disc, evenly (Vogel 1979, "A Better Way to Construct the Sunflower Head").
vec2 disc_point(int i, int count, float turn) {
    const float golden_angle = 2.39996323;
    float angle = golden_angle * float(i) + turn;
    return sqrt((float(i) + 0.5) / float(count)) * vec2(cos(angle), sin(angle));
}

// A direction about z, of `count` that are spread as the cosine.
vec3 cosine_direction(int i, int count) {
    vec2 at = disc_point(i, count, 0.0);
    return vec3(at, sqrt(max(1.0 - dot(at, at), 0.0)));
}

// A frame about a normal (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
mat3 frame_about(vec3 n) {
    float side = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (side + n.z);
    float b = n.x * n.y * a;
    return mat3(vec3(1.0 + side * n.x * n.x * a, side * b, -side * n.x), vec3(b, side + n.y * n.y * a, -n.y), n);
}
