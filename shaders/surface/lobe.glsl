// Directions of the lobe that a rough surface reflects, spread evenly by what each sends to the eye.
#include "common/directions.glsl"

// O'Neill 2014, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms for Random Number
// Generation"; as a hash: Jarzynski & Olano 2020, "Hash Functions for GPU Rendering".
uint scrambled(uint value) {
    uint state = value * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// A half vector as the eye sees the facets of a GGX surface (Heitz 2018, "Sampling the GGX Distribution of Visible
// Normals"). `v` and the result about z = the surface's normal.
vec3 visible_half_vector(vec3 v, float alpha, vec2 u) {
    vec3 stretched = normalize(vec3(alpha * v.xy, v.z));
    float length2 = dot(stretched.xy, stretched.xy);
    vec3 t1 = length2 > 0.0 ? vec3(-stretched.y, stretched.x, 0.0) * inversesqrt(length2) : vec3(1.0, 0.0, 0.0);
    vec3 t2 = cross(stretched, t1);
    float r = sqrt(u.x);
    float phi = 2.0 * pi * u.y;
    float p1 = r * cos(phi);
    float p2 = mix(sqrt(max(1.0 - p1 * p1, 0.0)), r * sin(phi), 0.5 * (1.0 + stretched.z));
    vec3 h = p1 * t1 + p2 * t2 + sqrt(max(1.0 - p1 * p1 - p2 * p2, 0.0)) * stretched;
    return normalize(vec3(alpha * h.xy, max(h.z, 1e-6)));
}

// Smith's masking of one direction, and of both with their heights correlated (Heitz 2014).
float smith_lambda(float cosine, float alpha) {
    float cosine2 = max(cosine * cosine, 1e-12);
    return 0.5 * (sqrt(1.0 + alpha * alpha * (1.0 - cosine2) / cosine2) - 1.0);
}
