// Colours by a formula, filtered over what a pixel covers. PATTERN: which, by PatternKind (scene/surface_detail.h).
//
// The pixel is a Gaussian: at half a period a pixel, above which samples alias, it leaves a tenth of a wave, a hundredth
// of its energy. A phase that changes by the steps dx and dy to the next pixels has under it the variance
// pixel_variance · (dx² + dy²), and a wave of k periods a unit of the phase is left exp(−2π²k²·variance) of (Apodaca &
// Gritz 1999, "Advanced RenderMan", chapter 11; Ebert et al. 2003, "Texturing and Modeling", chapter 2).
#define PATTERN_SQUARE_WAVE 0
#define PATTERN_CHECKER 1
#define PATTERN_NOISE 2
#define PATTERN_WOOD 3
#define PATTERN_MARBLE 4

uniform vec3 pattern_color, pattern_middle_color, pattern_second_color;
uniform float pattern_frequency, pattern_share, pattern_turbulence;
uniform vec3 pattern_direction;  // unit length
uniform int pattern_octaves;
#ifndef PATTERN_UV
in vec3 object_position;
#endif

const float pattern_pi = 3.14159265358979;
#ifdef PATTERN_UNFILTERED
const float pixel_variance = 0.0;
#else
const float pixel_variance = 0.46658;  // ln 10 / (2π² · ¼), square pixels
#endif

float variance_of(float dx, float dy) { return pixel_variance * (dx * dx + dy * dy); }

// What is left of a wave of so many periods a unit.
float wave_left(float periods, float variance) {
    return exp(-2.0 * pattern_pi * pattern_pi * periods * periods * variance);
}

// The share of a Gaussian below x standard deviations (the error function after Abramowitz & Stegun 1964, "Handbook of
// Mathematical Functions", 7.1.26: to 1.5e-7).
float gaussian_below(float x) {
    float z = min(abs(x) * 0.70710678, 9.0);
    float t = 1.0 / (1.0 + 0.3275911 * z);
    float rest = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) *
                 exp(-z * z);
    return x > 0.0 ? 1.0 - 0.5 * rest : 0.5 * rest;
}

// A wave that is 1 over the first `share` of each period and else 0.
float square_wave(float phase, float share, float variance) {
    float x = fract(phase);
#ifdef PATTERN_UNFILTERED
    return x < share ? 1.0 : 0.0;
#endif
    // Where a pixel is short against the period, few edges count; where it is not, few waves of its Fourier series. What
    // is left out is below 1e-5 on both sides of this.
    const float as_waves = 0.04;
    if (variance > as_waves) {
        float sum = share;
        for (int k = 1; k <= 3; ++k) {
            float periods = float(k);
            sum += 2.0 / (pattern_pi * periods) * sin(pattern_pi * periods * share) *
                   cos(2.0 * pattern_pi * periods * (x - 0.5 * share)) * wave_left(periods, variance);
        }
        return sum;
    }
    float per_deviation = inversesqrt(max(variance, 1e-12));
    float sum = 0.0;
    for (int n = -1; n <= 1; ++n) {
        float start = float(n) - x;
        sum += gaussian_below((start + share) * per_deviation) - gaussian_below(start * per_deviation);
    }
    return sum;
}

#if PATTERN >= PATTERN_NOISE
// Jarzynski & Olano 2020, "Hash Functions for GPU Rendering": pcg3d.
uvec3 scrambled_cell(uvec3 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

// Towards the middle of one of the twelve edges of a cube.
float slope_at(ivec3 corner, vec3 from) {
    uint edge = scrambled_cell(uvec3(corner)).x % 12u;
    float a = edge < 4u ? from.y : from.x;
    float b = edge < 8u ? from.z : from.y;
    return ((edge & 1u) == 0u ? a : -a) + ((edge & 2u) == 0u ? b : -b);
}

// Perlin 2002, "Improving Noise": about −1 to 1.
float gradient_noise(vec3 p) {
    vec3 cell = floor(p), f = p - cell;
    ivec3 at = ivec3(cell);
    vec3 s = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    vec4 low, high;
    for (int i = 0; i < 4; ++i) {
        ivec3 corner = ivec3(0, i & 1, i >> 1);
        low[i] = slope_at(at + corner, f - vec3(corner));
        corner.x = 1;
        high[i] = slope_at(at + corner, f - vec3(corner));
    }
    vec4 along_x = mix(low, high, s.x);
    vec2 along_y = mix(along_x.xz, along_x.yw, s.y);
    return mix(along_y.x, along_y.y, s.z);
}

// Octaves of half the height each, faded out as a pixel covers them (Norton, Rockwood & Skolmoski 1982, "Clamping: A
// Method of Antialiasing Textured Surfaces by Bandwidth Limiting in Object Space"): a Gaussian leaves of noise what it
// leaves of waves with its mean square slope.
float octaves_of_noise(vec3 p, vec3 dx, vec3 dy) {
    // Mean square slope over mean square of this noise along one axis, over (2π)²: from a million points of it.
    const float mean_periods2 = 0.172;
    float spread = pixel_variance * (dot(dx, dx) + dot(dy, dy));
    float sum = 0.0, height = 1.0, scale = 1.0;
    for (int i = 0; i < pattern_octaves; ++i) {
        float left = wave_left(scale, mean_periods2 * spread);
        // So little is no code value, and those after it are less.
        if (left < 1e-3) break;
        sum += height * left * gradient_noise(p * scale + 17.0 * float(i));
        height *= 0.5;
        scale *= 2.0;
    }
    return sum;
}

vec3 ramp(float t) {
    t = 2.0 * clamp(t, 0.0, 1.0);
    return t < 1.0 ? mix(pattern_second_color, pattern_middle_color, t)
                   : mix(pattern_middle_color, pattern_color, t - 1.0);
}
#endif

vec3 pattern_at(vec2 uv, vec2 uv_dx, vec2 uv_dy) {
#ifdef PATTERN_UV
    vec3 p = pattern_frequency * vec3(uv, 0.0);
    vec3 dx = pattern_frequency * vec3(uv_dx, 0.0), dy = pattern_frequency * vec3(uv_dy, 0.0);
#else
    vec3 p = pattern_frequency * object_position;
    vec3 dx = dFdx(p), dy = dFdy(p);
#endif
#if PATTERN == PATTERN_SQUARE_WAVE
    float wave = square_wave(dot(p, pattern_direction), pattern_share,
                             variance_of(dot(dx, pattern_direction), dot(dy, pattern_direction)));
    return mix(pattern_second_color, pattern_color, wave);
#elif PATTERN == PATTERN_CHECKER
    // A cell's middle lies at the origin, so that faces through it show cells, not the faces between them.
    float product = 1.0;
    for (int i = 0; i < 3; ++i) product *= 2.0 * square_wave(0.5 * p[i] + 0.25, 0.5, 0.25 * variance_of(dx[i], dy[i])) - 1.0;
    return mix(pattern_second_color, pattern_color, 0.5 + 0.5 * product);
#elif PATTERN == PATTERN_NOISE
    return ramp(0.5 + 0.5 * octaves_of_noise(p, dx, dy));
#else
    // Rings around a trunk, or layers; bent by noise of the same scale.
#if PATTERN == PATTERN_WOOD
    float way = length(p - dot(p, pattern_direction) * pattern_direction);
    // Along the trunk wood changes slowly.
    const float stretch = 0.85;
    mat3 bend = mat3(1.0) - stretch * outerProduct(pattern_direction, pattern_direction);
#else
    float way = dot(p, pattern_direction);
    const mat3 bend = mat3(1.0);
#endif
    // A few rings or veins in a bend of the noise.
    const float bends = 0.5;
    float phase = way + pattern_turbulence * octaves_of_noise(bends * bend * p, bends * bend * dx, bends * bend * dy);
    float variance = variance_of(dFdx(phase), dFdy(phase));
    float t = 0.0;
#if PATTERN == PATTERN_WOOD
    // A saw's teeth of five waves, smoothed as Lanczos has it: slowly dark, quickly bright.
    const int waves = 5;
    t = 0.5;
    for (int k = 1; k <= waves; ++k) {
        float periods = float(k), turn = pattern_pi * periods / float(waves + 1);
        t += sin(turn) / turn / (pattern_pi * periods) * sin(2.0 * pattern_pi * periods * phase) *
             wave_left(periods, variance);
    }
#else
    // 1 − |sin(π phase)| by its series: thin veins.
    const int waves = 6;
    t = 1.0 - 2.0 / pattern_pi;
    for (int k = 1; k <= waves; ++k) {
        float periods = float(k);
        t += 4.0 / pattern_pi / (4.0 * periods * periods - 1.0) * cos(2.0 * pattern_pi * periods * phase) *
             wave_left(periods, variance);
    }
#endif
    return ramp(t);
#endif
}
