// What a rough surface shows along its lobe, by rays. Include surface/lobe.glsl and common/object_light.glsl before, after
// light_from() and widened_roughness() of surface.frag.

// The lobe of a rough surface as `count` directions stand for it. The lobe's variance, which goes with alpha², is shared
// between where they go and how wide each is: wide enough to leave no gaps between them, in which a small lamp would
// flicker.
struct LobeRays {
    float roughness;   // of each
    float alpha;       // of where they go
    float eye_lambda;
};
LobeRays lobe_rays_of(float roughness, vec3 eye, float count, vec3 reflected_dx, vec3 reflected_dy) {
    const float overlap = 4.0;
    float ray_share = min(overlap / count, 0.75);
    float alpha = roughness * roughness * sqrt(1.0 - ray_share);
    return LobeRays(widened_roughness(roughness * sqrt(sqrt(ray_share)), reflected_dx, reflected_dy), alpha,
                    smith_lambda(eye.z, alpha));
}

// Where one of them goes, about z = the normal, and its weight; 0 where it would enter the surface.
float lobe_direction(LobeRays rays, vec3 eye, vec2 at, out vec3 direction) {
    direction = reflect(-eye, visible_half_vector(eye, rays.alpha, at));
    if (direction.z <= 0.0) return 0.0;
    return (1.0 + rays.eye_lambda) / (1.0 + rays.eye_lambda + smith_lambda(direction.z, rays.alpha));
}

// What the lobe of a rough surface shows: rays along it, each as wide as its share of the lobe (Křivánek & Colbert 2008,
// "Real-time Shading with Filtered Importance Sampling"), over the sum of their weights (Stachowiak 2015, "Stochastic
// Screen-Space Reflections"), so that even light comes out as it is. As far as they meet nothing they only correct what
// is beyond all objects, looked up in the same directions for all fragments (a control variate: Szirmay-Kalos et al. 2001,
// "Monte Carlo Global Illumination with Control Variates"), so that lamps in the open do not flicker from one to the next.
vec3 lobe_radiance(vec3 n, vec3 v, float roughness, vec3 reflected_dx, vec3 reflected_dy) {
    const int looks = 8;
    mat3 world_from_surface = frame_about(n);
    vec3 eye = v * world_from_surface;
    vec3 direction;
    LobeRays look = lobe_rays_of(roughness, eye, float(looks), reflected_dx, reflected_dy);
    vec3 beyond = vec3(0.0);
    float weights = 0.0;
    for (int i = 0; i < looks; ++i) {
        float weight = lobe_direction(look, eye, spread_point(uint(i), uvec2(1u << 30u)), direction);
        if (weight > 0.0) beyond += weight * light_beyond_objects(world_position, world_from_surface * direction, look.roughness);
        weights += weight;
    }
    if (weights <= 0.0) return light_from(reflect(-v, n), look.roughness);
    beyond /= weights;

    // Four fragments side by side share one sequence.
    LobeRays ray = lobe_rays_of(roughness, eye, float(4 * lobe_rays), reflected_dx, reflected_dy);
    uvec2 at = uvec2(gl_FragCoord.xy);
    uvec2 start = uvec2(scrambled((at.x >> 1u) + 65536u * (at.y >> 1u)), 0u);
    start.y = scrambled(start.x);
    uint first = uint(lobe_rays) * ((at.x & 1u) + 2u * (at.y & 1u));
    vec3 from = point_off(world_position, seen_side);
    vec3 arrives = vec3(0.0), beyond_rays = vec3(0.0);
    float open = 0.0;
    weights = 0.0;
    for (int i = 0; i < lobe_rays; ++i) {
        float weight = lobe_direction(ray, eye, spread_point(first + uint(i), start), direction);
        if (weight <= 0.0) continue;
        vec3 along = direction_off(world_from_surface * direction, seen_side);
        int first_met;
        vec3 radiance = light_along(from, along, ray.roughness, true, first_met);
        arrives += weight * radiance;
        if (first_met == meets_nothing) open += weight;
        beyond_rays += weight * (first_met == meets_nothing ? radiance : light_beyond_objects(from, along, ray.roughness));
        weights += weight;
    }
    if (weights <= 0.0) return beyond;
    return max(arrives + open * (beyond - beyond_rays / weights), vec3(0.0)) / weights;
}
