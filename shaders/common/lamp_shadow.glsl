// How much of an analytic light the objects let through. Include common/lamps.glsl and common/visibility.glsl before; with
// RAYS common/rays.glsl, too.
#include "common/directions.glsl"

// A face looks from the lamp at what casts; a lamp among the casters has six. Reversed z.
uniform sampler2DArray lamp_depth;
uniform int lamp_taps;                // where the lamp is no point, for each of two searches
uniform bool surface_hides_lamps;     // that are below it
#ifdef RAYS
uniform int lamp_rays;                // towards a lamp that is no point; 0: meshes are in the maps, too
#endif

// Another turn in each fragment, so that what few points leave open is noise and no pattern (Jimenez 2014, "Next Generation
// Post Processing in Call of Duty: Advanced Warfare").
#ifdef AT_VERTICES
float disc_turn() { return 0.0; }
#else
float disc_turn() { return 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))); }
#endif

mat2x3 across(vec3 direction) {
    vec3 axis = abs(direction.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
    vec3 u = normalize(cross(axis, direction));
    return mat2x3(u, cross(direction, u));
}

struct LampMap {
    int face;        // −1: nothing casts there
    float texel_m;   // of the map, at the point
    float depth_m;   // the point's distance along the face's axis; parallel light: 0
};

LampMap lamp_map_at(Lamp lamp, vec3 world_position) {
    int first = int(lamp.cone_shadow.z);
    for (int face = first; face < first + int(lamp.cone_shadow.w); ++face) {
        mat4 clip_from_world = lamp_clip_from_world[face];
        vec4 clip = clip_from_world * vec4(world_position, 1.0);
        if (clip.w <= 0.0 || any(greaterThan(abs(clip.xy), vec2(clip.w)))) continue;
        float per_m = length(vec3(clip_from_world[0].x, clip_from_world[1].x, clip_from_world[2].x));
        return LampMap(face, 2.0 * clip.w / (per_m * float(textureSize(lamp_depth, 0).x)), clip.w);
    }
    return LampMap(-1, 0.0, 0.0);
}

vec4 lamp_depths(int face, vec3 clip, out vec2 share) {
    vec2 size = vec2(textureSize(lamp_depth, 0).xy);
    vec2 at = (clip.xy * vec2(0.5, -0.5) + 0.5) * size - 0.5;
    share = fract(at);
    return textureGather(lamp_depth, vec3((floor(at) + 1.0) / size, float(face)));
}

// Of parallel light, behind all casters it is below 0, which is where the map has none.
float lamp_depth_of(vec4 clip) { return max(clip.z / clip.w, 0.0); }

// Whether casters leave the lamp's middle to a point: percentage-closer over the four nearest texels (Reeves, Salesin & Cook
// 1987, "Rendering Antialiased Shadows with Depth Maps").
float lamp_seen(int face, vec3 world_position) {
    vec4 clip = lamp_clip_from_world[face] * vec4(world_position, 1.0);
    vec2 t;
    vec4 depths = lamp_depths(face, clip.xyz / clip.w, t);
    vec4 seen = vec4(lessThanEqual(depths, vec4(lamp_depth_of(clip))));
    // In textureGather's order: (0, 1), (1, 1), (1, 0), (0, 0).
    return mix(mix(seen.w, seen.z, t.x), mix(seen.x, seen.y, t.x), t.y);
}

// Percentage-closer soft shadows (Fernando 2005): how far the casters are tells how wide the lamp is seen past them.
float lamp_seen_through_maps(Lamp lamp, LampLight light, vec3 world_position, vec3 n) {
    LampMap map = lamp_map_at(lamp, world_position);
    if (map.face < 0) return 1.0;
    float cosine = max(dot(n, light.to_lamp), 0.1);
    // Off the surface, and towards the lamp where it grazes it, by texels.
    float slope = sqrt(1.0 - min(cosine * cosine, 1.0)) / cosine;
    vec3 lifted = world_position + (1.5 * map.texel_m) * n + ((0.5 + slope) * map.texel_m) * light.to_lamp;
    if (lamp.light_size.w <= 0.0) return lamp_seen(map.face, lifted);
    mat4 clip_from_world = lamp_clip_from_world[map.face];
    bool is_placed = lamp_has(lamp, lamp_is_placed);
    mat2x3 disc = across(light.to_lamp);
    float turn = disc_turn();
    // Parallel light has depth 1 at the casters' nearest place and 0 at their farthest.
    float depth_per_m = length(vec3(clip_from_world[0].z, clip_from_world[1].z, clip_from_world[2].z));
    float own_depth = (clip_from_world * vec4(lifted, 1.0)).z / (is_placed ? map.depth_m : 1.0);
    float search_m = is_placed ? lamp.light_size.w * map.depth_m / max(clip_from_world[3].z, 1e-6)
                               : lamp.light_size.w * max(1.0 - own_depth, 0.0) / depth_per_m;
    // Farther than the map shows there is nothing to find.
    search_m = min(search_m, 0.25 * map.texel_m * float(textureSize(lamp_depth, 0).x));
    float nearer = 0.0, found = 0.0;
    for (int i = 0; i < lamp_taps; ++i) {
        vec3 aside = disc * (search_m * disc_point(i, lamp_taps, turn));
        vec3 at = lifted + aside - (dot(aside, n) / cosine) * light.to_lamp;
        vec4 clip = clip_from_world * vec4(at, 1.0);
        if (clip.w <= 0.0) continue;
        vec2 unused;
        float depth = lamp_depths(map.face, clip.xyz / clip.w, unused).w;
        if (depth <= lamp_depth_of(clip)) continue;
        nearer += is_placed ? 1.0 / depth : depth;
        found += 1.0;
    }
    if (found == 0.0) return 1.0;
    // Of a perspective, depth is near_m / distance.
    float caster = nearer / found;
    float own = is_placed ? 1.0 / max(own_depth, 1e-30) : own_depth;
    float width_m = is_placed ? lamp.light_size.w * max(own - caster, 0.0) / max(caster, 1e-30)
                              : lamp.light_size.w * max(caster - own, 0.0) / depth_per_m;
    float seen = 0.0;
    for (int i = 0; i < lamp_taps; ++i) {
        vec3 aside = disc * (max(width_m, map.texel_m) * disc_point(i, lamp_taps, turn));
        seen += lamp_seen(map.face, lifted + aside - (dot(aside, n) / cosine) * light.to_lamp);
    }
    return seen / float(lamp_taps);
}

#ifdef RAYS
// Spheres are in the maps. `side` is the triangle's normal towards the eye.
float lamp_seen_along_rays(LampLight light, vec3 world_position, vec3 side) {
    int count = light.size > 0.0 ? lamp_rays : 1;
    mat2x3 disc = across(light.to_lamp);
    float turn = disc_turn();
    vec3 from = point_off(world_position, dot(side, light.to_lamp) < 0.0 ? -side : side);
    float seen = 0.0;
    for (int i = 0; i < count; ++i) {
        vec2 at = light.size > 0.0 ? light.size * disc_point(i, count, turn) : vec2(0.0);
        vec3 direction = normalize(light.to_lamp + disc * at);
        seen += nearest_hit_of(ray_instance_count, from, direction, light.distance_m).instance < 0 ? 1.0 : 0.0;
    }
    return seen / float(count);
}
#endif

// `side` as for rays; `n` the normal of what casts.
float lamp_share_left(Lamp lamp, LampLight light, vec3 world_position, vec3 n, vec3 side) {
    if (surface_hides_lamps && world_position.z > surface_z_m &&
        (lamp_has(lamp, lamp_is_placed) ? lamp.place_kind.z < surface_z_m : lamp.place_kind.z < 0.0))
        return 0.0;
    float left = 1.0;
    if (lamp.cone_shadow.w > 0.0) left = lamp_seen_through_maps(lamp, light, world_position, n);
#ifdef RAYS
    if (lamp_rays > 0 && left > 0.0 && lamp.cone_shadow.z >= 0.0) left *= lamp_seen_along_rays(light, world_position, side);
#endif
#ifdef RELIEF_SHADOW
    if (left > 0.0 && lamp.cone_shadow.z >= 0.0) left *= relief_light_left(light.to_lamp, light.size);
#endif
    return left;
}
