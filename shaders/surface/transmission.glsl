// What shows through a surface that lets light pass. Include common/near_light.glsl and common/material_layers.glsl before.
uniform mat4 world_from_model;

// A way through what is behind a surface.
struct WayThrough {
    vec3 exit, direction;   // world
    float inside;           // in the mesh's own units
};

// As if it were a ball there, as thick as the material says: refracted where it enters and where it leaves it. A thin
// wall, of thickness 0, bends nothing.
WayThrough way_through(vec3 n, vec3 v, float thickness) {
    if (!(thickness > 0.0)) return WayThrough(world_position, -v, 0.0);
    vec3 inside = refract(-v, n, 1.0 / refractive_index);
    float cosine = dot(n, inside);
    vec3 back_n = normalize(2.0 * cosine * inside - n);   // of the ball, where the way leaves it, against the way
    float way = thickness * -cosine;
    // How long a unit of the mesh is along the way.
    vec3 model_inside = inverse(mat3(world_from_model)) * inside;
    float metres = way / max(length(model_inside), 1e-20);
    vec3 direction = refract(inside, back_n, refractive_index);
    return WayThrough(world_position + metres * inside, direction == vec3(0.0) ? inside : direction, way);
}

// How wide a lobe lies on what is as far behind the surface as the eye is before it, in shares of a picture in which a
// unit of tangent takes `tangent_share`.
float spread_in_picture(float roughness, float tangent_share) {
    return lobe_width * roughness * roughness * tangent_share;
}
float level_of(float spread, vec2 size) { return log2(max(spread * size.x, 1.0)); }

// Opaque virtual things where the way leaves what lets it through, as they are drawn so far; premultiplied.
uniform bool backdrop_present;
uniform sampler2D backdrop;
uniform mat4 backdrop_from_world;   // clip space
uniform vec2 backdrop_size_px;

vec4 virtual_behind(WayThrough way, float roughness) {
    if (!backdrop_present) return vec4(0.0);
    vec4 clip = backdrop_from_world * vec4(way.exit, 1.0);
    if (!(clip.w > 0.0)) return vec4(0.0);
    vec2 share = vec2(clip.x, -clip.y) / clip.w * 0.5 + 0.5;
    if (any(lessThan(share, vec2(0.0))) || any(greaterThan(share, vec2(1.0)))) return vec4(0.0);
    float tangent_share = 0.5 * length(transpose(backdrop_from_world)[0].xyz);
    vec2 size = vec2(textureSize(backdrop, 0));
    vec2 at = share * backdrop_size_px / size;
    return textureLod(backdrop, at, level_of(spread_in_picture(roughness, tangent_share), backdrop_size_px));
}

// What the frame shows of where a way ends: on the real surface, or far away. Premultiplied with how much it shows of it.
uniform bool plate_behind_present;
uniform sampler2D plate_behind;
uniform mat4 plate_behind_from_world;   // shares of the picture

vec4 plate_along(WayThrough way, float roughness) {
    if (!plate_behind_present) return vec4(0.0);
    vec3 met;
    bool is_near = (surface_is_near != 0 || surface_shadow_present != 0) &&
                   meets_surface(way.exit, way.direction, met);
    // Towards what is infinitely far away only the direction counts.
    vec3 seen = (plate_behind_from_world * (is_near ? vec4(met, 1.0) : vec4(way.direction, 0.0))).xyz;
    if (!(seen.z > 0.0)) return vec4(0.0);
    vec2 share = seen.xy / seen.z;
    if (any(lessThan(share, vec2(0.0))) || any(greaterThan(share, vec2(1.0)))) return vec4(0.0);
    float tangent_share = length(transpose(plate_behind_from_world)[0].xyz);
    vec4 light = textureLod(plate_behind, share,
                            level_of(spread_in_picture(roughness, tangent_share), vec2(textureSize(plate_behind, 0))));
    return is_near && surface_shadow_present != 0 ? vec4(light.rgb * contact_shadow(met.xy), light.a) : light;
}

// The light that comes along a way: from opaque virtual things, from what the frame shows, from what the clip knows of the
// real surface, or from the probe.
vec3 light_behind(WayThrough way, float roughness) {
    vec4 nearer = virtual_behind(way, roughness);
    if (nearer.a >= 1.0) return nearer.rgb;
    vec4 filmed = plate_along(way, roughness);
    vec3 light = filmed.rgb;
    if (filmed.a < 1.0) {
#if defined(RAYS) || defined(PLANE)
        vec3 known = light_beyond_objects(way.exit, way.direction, roughness);
#else
        vec3 known = reflected_radiance(direction_in_probe(way.exit, way.direction), roughness) *
                     light_left_along(way.exit, way.direction);
#endif
        light += (1.0 - filmed.a) * known;
    }
    return nearer.rgb + (1.0 - nearer.a) * light;
}

// Rough surfaces spread what passes as they spread what they mirror; less so those that hardly bend it (Khronos 2021,
// glTF-Sample-Renderer). Absorption is Beer's and Lambert's.
vec3 light_through(vec3 n, vec3 v, float roughness, float thickness) {
    WayThrough way = way_through(n, v, thickness);
    // As the mirrored lobe does, this one leans towards the normal.
    way.direction = normalize(mix(way.direction, -n, pow(roughness, 4.0)));
    float spread = thickness > 0.0 ? sqrt(clamp(2.0 * refractive_index - 2.0, 0.0, 1.0)) : 1.0;
    return exp(-absorbed_per_unit * way.inside) * light_behind(way, roughness * spread);
}
