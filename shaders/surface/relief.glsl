// Where the ray from the eye meets the heights that a map carves into a surface. RELIEF: which way it is found, by
// ReliefMethod (scene/surface_detail.h). Outlines, and where the surface is for light, stay those of the flat surface; of a
// lamp's light the heights take what they hide.
#define RELIEF_BUMP 0
#define RELIEF_PARALLAX 1
#define RELIEF_OCCLUSION 2
#define RELIEF_SEARCH 3
#define RELIEF_CONE_STEP 4
#define RELIEF_SPHERE_TRACING 5

uniform vec3 eye_world;
uniform sampler2D relief_map;    // height 0..1, its slope along u and v, how wide a cone opens
uniform float relief_depth_m;    // of height 0
uniform int relief_steps;
#if RELIEF == RELIEF_SPHERE_TRACING
uniform sampler2DArray relief_distances;  // in depths, in layers downwards
uniform vec2 relief_extent;               // of the map on the surface, in depths: the metric of the distances
#endif

// What is seen in place of the flat surface.
vec2 relief_uv;
vec3 relief_normal;
vec3 relief_flat_normal;
float relief_share = 1.0;  // of the way from the eye that the flat surface is at
#define inverse_z() (gl_FragCoord.w * relief_share)
#if RELIEF >= RELIEF_OCCLUSION && defined(LAMPS)
#define RELIEF_SHADOW
mat2x3 relief_gradients;
float relief_depth;        // that the ray from the eye met the ground at
float relief_lod;
#endif

#if RELIEF != RELIEF_BUMP
layout(depth_less) out float gl_FragDepth;
#endif

// A ray below the surface, by depth: 0 at the surface, 1 at the deepest.
struct ReliefRay {
    vec2 uv, uv_per_depth;
    float lod;  // of the map, where a texel is as wide as the pixel
};

// Height of the ground over the ray; negative where the ray is below it.
float ray_above(ReliefRay ray, float depth) {
    return 1.0 - textureLod(relief_map, ray.uv + depth * ray.uv_per_depth, ray.lod).r - depth;
}

// Between a point above the ground and one below it, the crossing of a straight ground.
float straight_crossing(float above_depth, float above, float below_depth, float below) {
    return mix(above_depth, below_depth, above / max(above - below, 1e-6));
}

#if RELIEF == RELIEF_PARALLAX
// One look, the shift no longer than the height, so that it stays bounded at grazing angles (Kaneko et al. 2001, "Detailed
// Shape Representation with Parallax Mapping"; the limit: Welsh 2004, "Parallax Mapping with Offset Limiting").
float depth_met(ReliefRay ray, float cosine) { return cosine * ray_above(ray, 0.0); }
#elif RELIEF == RELIEF_OCCLUSION || RELIEF == RELIEF_SEARCH
float depth_met(ReliefRay ray, float cosine) {
    float step_depth = 1.0 / float(relief_steps);
    float above_depth = 0.0, above = ray_above(ray, 0.0);
    float below_depth = 1.0, below = -1e-6;
    for (int i = 1; i <= relief_steps; ++i) {
        float depth = float(i) * step_depth;
        float gap = ray_above(ray, depth);
        if (gap <= 0.0) {
            below_depth = depth;
            below = gap;
            break;
        }
        above_depth = depth;
        above = gap;
    }
#if RELIEF == RELIEF_SEARCH
    // Policarpo, Oliveira & Comba 2005, "Real-Time Relief Mapping on Arbitrary Polygonal Surfaces": halved, a few times.
    const int halvings = 6;
    for (int i = 0; i < halvings; ++i) {
        float depth = 0.5 * (above_depth + below_depth);
        float gap = ray_above(ray, depth);
        if (gap > 0.0) {
            above_depth = depth;
            above = gap;
        } else {
            below_depth = depth;
            below = gap;
        }
    }
#endif
    // Tatarchuk 2006, "Dynamic Parallax Occlusion Mapping with Approximate Soft Shadows".
    return straight_crossing(above_depth, above, below_depth, below);
}
#elif RELIEF == RELIEF_CONE_STEP
// Dummer 2006, "Cone Step Mapping": to the edge of the cone that the map keeps free above the ground.
float depth_met(ReliefRay ray, float cosine) {
    const float near_enough = 1.0 / 512.0;
    float along = length(ray.uv_per_depth);
    float depth = 0.0, gap = 1.0, before_depth = 0.0, before_gap = 2.0;
    for (int i = 0; i < relief_steps; ++i) {
        vec4 texel = textureLod(relief_map, ray.uv + depth * ray.uv_per_depth, ray.lod);
        gap = 1.0 - texel.r - depth;
        if (gap <= near_enough || i == relief_steps - 1) break;
        before_depth = depth;
        before_gap = gap;
        depth += gap * texel.a / (along + texel.a);
    }
    // The steps end a little above the ground, of which two points tell the slope; no deeper than straight below.
    float crossing = straight_crossing(before_depth, before_gap, depth, gap);
    return clamp(crossing, depth, min(depth + max(gap, 0.0), 1.0));
}
#elif RELIEF == RELIEF_SPHERE_TRACING
// Donnelly 2005, "Per-Pixel Displacement Mapping with Distance Functions", GPU Gems 2, chapter 8. The distances are kept
// on coarse cells, so that they end a little above the ground: from there in small steps.
float depth_met(ReliefRay ray, float cosine) {
    vec3 size = vec3(textureSize(relief_distances, 0));
    float depth_per_way = 1.0 / length(vec3(ray.uv_per_depth * relief_extent, 1.0));
    float least = 1.0 / float(relief_steps);
    float depth = 0.0, gap = ray_above(ray, 0.0);
    for (int i = 0; i < relief_steps; ++i) {
        vec2 uv = ray.uv + depth * ray.uv_per_depth;
        float layer = depth * (size.z - 1.0);
        float upper = floor(layer);
        float far = mix(textureLod(relief_distances, vec3(uv, upper), 0.0).r,
                        textureLod(relief_distances, vec3(uv, min(upper + 1.0, size.z - 1.0)), 0.0).r, layer - upper);
        float next = min(depth + max(far * depth_per_way, least), 1.0);
        float next_gap = ray_above(ray, next);
        if (next_gap <= 0.0) return straight_crossing(depth, gap, next, next_gap);
        depth = next;
        gap = next_gap;
    }
    return depth;
}
#endif

// By how much u and v grow a metre along the surface, as directions in the world (Mikkelsen 2010, "Bump Mapping
// Unparametrized Surfaces on the GPU"): from the triangle itself, so that neither tangents nor the way the picture lies
// on it, mirrored or not, matter. Zero where there is no picture or no triangle.
mat2x3 uv_gradients(vec3 dx, vec3 dy, vec2 uv_dx, vec2 uv_dy) {
    vec3 n = cross(dx, dy);
    float area2 = dot(n, n);
    if (!(area2 > 0.0)) return mat2x3(0.0);
    vec3 across = cross(dy, n) / area2, up = cross(n, dx) / area2;
    return mat2x3(across * uv_dx.x + up * uv_dy.x, across * uv_dx.y + up * uv_dy.y);
}

#ifdef RELIEF_SHADOW
// The share of a lamp, whose half angle is `size`, that the ground around leaves to what is seen: the least clearance of a
// ray to its middle, as an angle, against the lamp's disc. Policarpo, Oliveira & Comba 2005, the penumbra as Tatarchuk 2006.
float relief_light_left(vec3 to_lamp, float size) {
    if (relief_gradients == mat2x3(0.0) || relief_depth <= 0.0) return 1.0;
    // A lamp below the flat surface is behind its ground.
    float cosine = dot(relief_flat_normal, to_lamp);
    if (cosine <= 0.0) return 0.0;
    const float least_cosine = 1e-3;
    cosine = max(cosine, least_cosine);
    vec2 uv_per_m = to_lamp * relief_gradients;
    vec2 texels_per_m = abs(uv_per_m) * vec2(textureSize(relief_map, 0)) * exp2(-relief_lod);
    float texel_m = 1.0 / max(max(texels_per_m.x, texels_per_m.y), 1e-6);
    // Slopes are known to a texel or two: nearer, the ground is as flat as the normal says.
    const float first_texels = 1.5, sharpness_texels = 0.1;
    float way_m = relief_depth * relief_depth_m / cosine;
    float step_m = way_m / float(relief_steps);
    float sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    vec2 uv_per_depth = -uv_per_m * (relief_depth_m / cosine);
    ReliefRay ray = ReliefRay(relief_uv - relief_depth * uv_per_depth, uv_per_depth, relief_lod);
    float left = 1.0;
    for (float at_m = max(step_m, first_texels * texel_m); at_m < way_m && left > 0.0; at_m += step_m) {
        float clear_m = ray_above(ray, relief_depth * (1.0 - at_m / way_m)) * relief_depth_m * sine;
        left = min(left, 0.5 + 0.5 * clear_m / (size * at_m + sharpness_texels * texel_m));
    }
    return max(left, 0.0);
}
#endif

bool see() {
    relief_uv = material_uv;
    relief_normal = world_normal;
    relief_flat_normal = normalize(world_normal);
#ifdef RELIEF_SHADOW
    relief_gradients = mat2x3(0.0);
#endif
    relief_uv_dx = dFdx(material_uv);
    relief_uv_dy = dFdy(material_uv);
    vec3 dx = dFdx(world_position), dy = dFdy(world_position);
#if RELIEF != RELIEF_BUMP
    gl_FragDepth = gl_FragCoord.z;
#endif
    mat2x3 gradients = uv_gradients(dx, dy, relief_uv_dx, relief_uv_dy);
    // From behind the carving is not seen.
    if (!front_facing || gradients == mat2x3(0.0)) return true;
    vec3 n = relief_flat_normal;
#if RELIEF != RELIEF_BUMP
    vec3 towards = world_position - eye_world;
    float way_m = length(towards);
    // Along the surface a ray would never get to the ground.
    const float least_cosine = 1e-3;
    float cosine = max(-dot(n, towards) / way_m, least_cosine);
    vec2 texels = vec2(textureSize(relief_map, 0));
    vec2 across = relief_uv_dx * texels, up = relief_uv_dy * texels;
    // A pixel that lies long on the map is as narrow as its narrow side: along its long one there is the search.
    float span2 = min(dot(across, across), dot(up, up));
    ReliefRay ray = ReliefRay(material_uv, (towards / way_m * relief_depth_m / cosine) * gradients,
                              0.5 * log2(max(span2, 1.0)));
    float depth = depth_met(ray, cosine);
    relief_uv += depth * ray.uv_per_depth;
#ifdef RELIEF_SHADOW
    relief_gradients = gradients;
    relief_depth = depth;
    relief_lod = ray.lod;
#endif
    relief_share = way_m / (way_m + depth * relief_depth_m / cosine);
    gl_FragDepth = gl_FragCoord.z * relief_share;
#endif
    // Blinn 1978, "Simulation of Wrinkled Surfaces". With a map of normals that map tells.
    if ((material_textures & has_normal) == 0) {
        vec3 slope = relief_depth_m * (gradients * sampled(relief_map, relief_uv).gb);
        relief_normal = n - (slope - dot(slope, n) * n);
    }
    return true;
}

#define material_uv relief_uv
#define world_normal relief_normal
