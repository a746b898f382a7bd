// Rays against the virtual objects, by a hierarchy of boxes for each mesh (scene/triangle_tree.h, render/ray_scene.h), and
// with RAY_SPHERES for each set of spheres.

// Floats and integers as bits, so that neither is changed on its way.
uniform usamplerBuffer ray_nodes;       // low xyz, skip: the node after all of its own;
                                        // high xyz, leaf: first triangle · 8 + number of triangles, 0: an inner node
uniform usamplerBuffer ray_triangles;   // a corner, two edges; w: the vertex there, at the first and the second edge's end
uniform samplerBuffer ray_instances;    // rows of world_from_model and of model_from_world
uniform isamplerBuffer ray_ranges;      // of each: first node, end node, first triangle, first vertex · 2 + whether its
                                        // back faces are never met (it is closed); −1: a real thing
uniform samplerBuffer ray_vertices;     // normal in the model's own axes, roughness; base colour, metallic
uniform int ray_instance_count;
#ifdef RAY_SPHERES
uniform int ray_sphere_set_count;       // instances after the others, with three texels a sphere in place of a triangle:
                                        // its centre and radius, its base colour; the first vertex has the rest
#endif

vec4 ray_vertex_normal_roughness(int vertex) { return texelFetch(ray_vertices, 2 * vertex); }
vec4 ray_vertex_base_metallic(int vertex) { return texelFetch(ray_vertices, 2 * vertex + 1); }

// Rows 0 to 2 of an affine transform: of world_from_model (first = 0) or of model_from_world (3).
mat4x3 ray_transform(int instance, int first) {
    return mat4x3(transpose(mat3x4(texelFetch(ray_instances, 6 * instance + first),
                                   texelFetch(ray_instances, 6 * instance + first + 1),
                                   texelFetch(ray_instances, 6 * instance + first + 2))));
}

struct RayHit {
    float distance_m;   // in multiples of the direction's length
    int instance;       // −1: nothing was met
    int triangle;
    vec2 at;            // shares of the second and the third corner
};

// Möller & Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection". A shared edge belongs to both sides, so
// that no ray slips through between them.
void meet_triangle(vec3 origin, vec3 direction, int instance, int triangle, bool is_closed, inout RayHit hit) {
    const float edge_share = 1e-6;
    vec3 edge1 = uintBitsToFloat(texelFetch(ray_triangles, 3 * triangle + 1).xyz);
    vec3 edge2 = uintBitsToFloat(texelFetch(ray_triangles, 3 * triangle + 2).xyz);
    vec3 p = cross(direction, edge2);
    float determinant = dot(edge1, p);
    // Only rays that begin within a closed shape meet its back: between its triangles and the smooth surface that they
    // stand for.
    if (determinant == 0.0 || (is_closed && determinant < 0.0)) return;
    float inverse = 1.0 / determinant;
    vec3 from_corner = origin - uintBitsToFloat(texelFetch(ray_triangles, 3 * triangle).xyz);
    float u = dot(from_corner, p) * inverse;
    vec3 q = cross(from_corner, edge1);
    float v = dot(direction, q) * inverse;
    float distance_m = dot(edge2, q) * inverse;
    if (u < -edge_share || v < -edge_share || u + v > 1.0 + edge_share) return;
    if (!(distance_m > 0.0 && distance_m < hit.distance_m)) return;
    hit = RayHit(distance_m, instance, triangle, vec2(u, v));
}

#ifdef RAY_SPHERES
// From outside: what leaves a sphere, or begins within it by rounding, does not meet it again (spheres/ray.glsl says whose
// form this is).
void meet_ray_sphere(vec3 origin, vec3 direction, int instance, int sphere, inout RayHit hit) {
    vec4 centre_radius = uintBitsToFloat(texelFetch(ray_triangles, 3 * sphere));
    float radius = centre_radius.w;
    vec3 from_centre = origin - centre_radius.xyz;
    float away = length(from_centre);
    float power = (away - radius) * (away + radius);
    float b = dot(from_centre, direction);
    if (b >= 0.0 || power <= 0.0) return;
    float a = dot(direction, direction);
    float off = length(from_centre - (b / a) * direction);
    float left = (radius - off) * (radius + off);
    if (!(left >= 0.0)) return;
    float distance_m = power / (sqrt(a * left) - b);
    if (distance_m < hit.distance_m) hit = RayHit(distance_m, instance, sphere, vec2(0.0));
}

bool is_ray_sphere(RayHit hit) { return hit.instance >= ray_instance_count; }
#endif

// The nearest triangle, either side of it, or sphere, nearer than `farthest_m`. The direction may have any length but 0.
RayHit nearest_hit_of(int instances, vec3 world_origin, vec3 world_direction, float farthest_m) {
    RayHit hit = RayHit(farthest_m, -1, 0, vec2(0.0));
    for (int i = 0; i < instances; ++i) {
        mat4x3 model_from_world = ray_transform(i, 3);
        vec3 origin = model_from_world * vec4(world_origin, 1.0);
        vec3 direction = mat3(model_from_world) * world_direction;
        // Along an axis the slabs are met nowhere or everywhere; a tiny slope gives either, without 0 · ∞.
        const float least_slope = 1e-20;
        vec3 slope = mix(direction, vec3(least_slope), lessThan(abs(direction), vec3(least_slope)));
        vec3 inverse = 1.0 / slope;
        ivec4 range = texelFetch(ray_ranges, i);
        int node = range.x, end = range.y, first_triangle = range.z;
        bool is_closed = range.w >= 0 && (range.w & 1) != 0;
        while (node < end) {
            uvec4 low_skip = texelFetch(ray_nodes, 2 * node);
            uvec4 high_leaf = texelFetch(ray_nodes, 2 * node + 1);
            vec3 to_low = (uintBitsToFloat(low_skip.xyz) - origin) * inverse;
            vec3 to_high = (uintBitsToFloat(high_leaf.xyz) - origin) * inverse;
            vec3 nearer = min(to_low, to_high), farther = max(to_low, to_high);
            float enters = max(max(nearer.x, nearer.y), max(nearer.z, 0.0));
            float leaves = min(min(farther.x, farther.y), min(farther.z, hit.distance_m));
            // Rounding of the slabs' distances must lose no box (Ize 2013, "Robust BVH Ray Traversal").
            const float rounding = 1.0000004;
            if (enters > leaves * rounding) {
                node = int(low_skip.w);
                continue;
            }
            uint leaf = high_leaf.w;
            int first = first_triangle + int(leaf >> 3u);
            for (int triangle = first; triangle < first + int(leaf & 7u); ++triangle) {
#ifdef RAY_SPHERES
                if (i >= ray_instance_count) {
                    meet_ray_sphere(origin, direction, i, triangle, hit);
                    continue;
                }
#endif
                meet_triangle(origin, direction, i, triangle, is_closed, hit);
            }
            ++node;
        }
    }
    return hit;
}

RayHit nearest_hit(vec3 world_origin, vec3 world_direction, float farthest_m) {
#ifdef RAY_SPHERES
    return nearest_hit_of(ray_instance_count + ray_sphere_set_count, world_origin, world_direction, farthest_m);
#else
    return nearest_hit_of(ray_instance_count, world_origin, world_direction, farthest_m);
#endif
}

bool is_real(RayHit hit) { return texelFetch(ray_ranges, hit.instance).w < 0; }

// What lies where a ray ends, if it is not real.
struct RaySurface {
    vec3 world_position, world_normal;   // the normal on the side that the ray came from
    vec3 geometric_normal;               // of the triangle, on that side too
    bool is_back;                        // that it is not the side that the model's normals are on
    vec3 base;
    float metallic, roughness;
    ivec3 vertices;                      // the triangle's corners among all vertices
    vec3 shares;                         // of them
};

#ifdef RAY_SPHERES
// `world_met` is the place that was met.
RaySurface sphere_surface_at(RayHit hit, vec3 world_met) {
    vec4 centre_radius = uintBitsToFloat(texelFetch(ray_triangles, 3 * hit.triangle));
    vec3 outward = normalize(ray_transform(hit.instance, 3) * vec4(world_met, 1.0) - centre_radius.xyz);
    RaySurface surface;
    surface.vertices = ivec3(texelFetch(ray_ranges, hit.instance).w >> 1);
    surface.shares = vec3(1.0, 0.0, 0.0);
    surface.world_position =
        ray_transform(hit.instance, 0) * vec4(centre_radius.xyz + centre_radius.w * outward, 1.0);
    surface.world_normal = normalize(transpose(mat3(ray_transform(hit.instance, 3))) * outward);
    surface.geometric_normal = surface.world_normal;
    surface.is_back = true;   // no light is kept for it: of the vertex's only the emission counts
    surface.base = uintBitsToFloat(texelFetch(ray_triangles, 3 * hit.triangle + 1).xyz);
    surface.metallic = ray_vertex_base_metallic(surface.vertices.x).a;
    surface.roughness = ray_vertex_normal_roughness(surface.vertices.x).w;
    return surface;
}
#endif

RaySurface surface_at(RayHit hit, vec3 world_origin, vec3 world_direction) {
#ifdef RAY_SPHERES
    if (is_ray_sphere(hit)) return sphere_surface_at(hit, world_origin + hit.distance_m * world_direction);
#endif
    uvec4 corner = texelFetch(ray_triangles, 3 * hit.triangle);
    uvec4 edge1 = texelFetch(ray_triangles, 3 * hit.triangle + 1);
    uvec4 edge2 = texelFetch(ray_triangles, 3 * hit.triangle + 2);
    RaySurface surface;
    surface.vertices = (texelFetch(ray_ranges, hit.instance).w >> 1) + ivec3(corner.w, edge1.w, edge2.w);
    surface.shares = vec3(1.0 - hit.at.x - hit.at.y, hit.at);
    vec3 along1 = uintBitsToFloat(edge1.xyz), along2 = uintBitsToFloat(edge2.xyz);
    vec3 position = uintBitsToFloat(corner.xyz) + hit.at.x * along1 + hit.at.y * along2;
    surface.world_position = ray_transform(hit.instance, 0) * vec4(position, 1.0);
    vec4 normal_roughness = vec4(0.0), base_metallic = vec4(0.0);
    for (int i = 0; i < 3; ++i) {
        normal_roughness += surface.shares[i] * ray_vertex_normal_roughness(surface.vertices[i]);
        base_metallic += surface.shares[i] * ray_vertex_base_metallic(surface.vertices[i]);
    }
    mat3 normal_from_model = transpose(mat3(ray_transform(hit.instance, 3)));
    surface.geometric_normal = normalize(normal_from_model * cross(along1, along2));
    if (dot(surface.geometric_normal, world_direction) > 0.0) surface.geometric_normal = -surface.geometric_normal;
    surface.world_normal = normalize(normal_from_model * normal_roughness.xyz);
    surface.is_back = dot(surface.world_normal, surface.geometric_normal) < 0.0;
    if (surface.is_back) surface.world_normal = -surface.world_normal;
    surface.base = base_metallic.rgb;
    surface.metallic = base_metallic.a;
    surface.roughness = normal_roughness.w;
    return surface;
}

// A direction off a surface: an interpolated normal may have sent it into the triangle.
vec3 direction_off(vec3 direction, vec3 geometric_normal) {
    const float least_rise = 1e-3;
    float rise = dot(direction, geometric_normal);
    return rise < least_rise ? normalize(direction + (least_rise - rise) * geometric_normal) : direction;
}

// A point just off a surface, so that a ray from it does not meet that surface again: as many steps of the floats
// there as the intersection may err by, and no less than a share of its distance (after Wächter & Binder 2019, "A Fast
// and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems, ch. 6).
vec3 point_off(vec3 world_position, vec3 geometric_normal) {
    const float share = 3e-6;
    vec3 size = abs(world_position);
    return world_position + geometric_normal * (share * max(max(size.x, size.y), max(size.z, 0.01)));
}
