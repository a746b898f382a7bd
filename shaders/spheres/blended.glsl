// What a transparent sphere adds to a pixel where no order is kept (render/sphere_blending.h).
#ifdef WEIGHTED_BLENDED
layout(location = 1) out float covered;
uniform float weight_per_m;  // depths of 0.1 to 500 for its formula

// McGuire & Bavoil 2013, "Weighted Blended Order-Independent Transparency", eq. 9, times the opacity.
vec4 blended(vec3 light, float alpha) {
    covered = alpha;
    float depth = weight_per_m / inverse_z();
    float weight = alpha * clamp(0.03 / (1e-5 + pow(depth / 200.0, 4.0)), 1e-2, 3e3);
    return alpha * weight * vec4(light, 1.0);
}
#endif

#if defined(GATHER_MOMENTS) || defined(BLEND_BY_MOMENTS)
uniform vec2 depth_logs;  // of the nearest and the farthest that can be met, in metres

// −1 to 1: depths as far apart as their logarithms.
float warped_depth() {
    return clamp(2.0 * (-log(inverse_z()) - depth_logs.x) / (depth_logs.y - depth_logs.x) - 1.0, -1.0, 1.0);
}
float absorbance_of(float alpha) { return -log(1.0 - min(alpha, 0.999999)); }
#endif

#ifdef GATHER_MOMENTS
layout(location = 1) out float absorbance;

// The first four powers of the depth, by how much it absorbs (Münstermann, Krumpen, Klein & Peters 2018, "Moment-Based
// Order-Independent Transparency").
vec4 blended(vec3 light, float alpha) {
    absorbance = absorbance_of(alpha);
    float z = warped_depth();
    return absorbance * vec4(z, z * z, z * z * z, z * z * z * z);
}
#endif

#ifdef BLEND_BY_MOMENTS
uniform sampler2D gathered_moments, gathered_absorbance;

// What all that absorbs before a depth lets through: of the distributions of absorbance that have these moments the one
// with three steps, one of them at the depth, which counts as a quarter (their algorithm 2).
float let_through_before(float depth) {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float whole = texelFetch(gathered_absorbance, pixel, 0).r;
    if (whole <= 0.0) return 1.0;
    const float bias = 5e-7;  // theirs for single precision
    vec4 b = mix(texelFetch(gathered_moments, pixel, 0) / whole, vec4(0.0, 0.375, 0.0, 0.375), bias);
    // The kernel polynomial of the Hankel matrix, by its Cholesky factors.
    float l21_d11 = b.z - b.x * b.y;
    float d11 = b.y - b.x * b.x;
    float l21 = l21_d11 / d11;
    float d22 = (b.w - b.y * b.y) - l21_d11 * l21;
    vec3 c = vec3(1.0, depth, depth * depth);
    c.y -= b.x;
    c.z -= b.y + l21 * c.y;
    c.y /= d11;
    c.z /= d22;
    c.y -= l21 * c.z;
    c.x -= dot(c.yz, b.xy);
    float half_p = 0.5 * c.y / c.z;
    float root = sqrt(max(half_p * half_p - c.x / c.z, 0.0));
    float z1 = -half_p - root, z2 = -half_p + root;
    const float share_at_depth = 0.25;
    float f1 = z1 < depth ? 1.0 : 0.0, f2 = z2 < depth ? 1.0 : 0.0;
    float f01 = (f1 - share_at_depth) / (z1 - depth);
    float f12 = (f2 - f1) / (z2 - z1);
    float f012 = (f12 - f01) / (z2 - depth);
    float share = share_at_depth + f01 * (b.x - depth) + f012 * (b.y - (depth + z1) * b.x + depth * z1);
    // Steps upon each other say nothing.
    if (!(share >= 0.0)) share = share_at_depth;
    return exp(-whole * min(share, 1.0));
}

vec4 blended(vec3 light, float alpha) { return let_through_before(warped_depth()) * alpha * vec4(light, 1.0); }
#endif

#ifdef WEIGHTED_SUM
// Meshkin 2007, "Sort-Independent Alpha Blending".
vec4 blended(vec3 light, float alpha) { return alpha * vec4(light, 1.0); }
#endif
