// Analytic lights (render/lamps.h): what arrives from each where nothing is in the way. Falloff and cones are those of glTF's
// KHR_lights_punctual.

struct Lamp {
    vec4 place_kind;   // where it stands, m; a directional one: where its light comes from, unit; w: bits below
    vec4 axis_range;   // the direction of its light, unit; 1/range, 0: endless
    vec4 light_size;   // irradiance at 1 m; radius, m. Directional: irradiance; tangent of half its angle
    vec4 cone_shadow;  // scale and offset of the cosine to the axis; first of its shadow's faces, how many
};
const int lamp_is_placed = 1, lamp_in_footage = 2;
const int lamp_of_probe = 4;  // it stands for a bright part of the probe: for classic shading alone

const int most_lamps = 32;
layout(std140, binding = 1) uniform Lamps {
    Lamp lamps[most_lamps];
    mat4 lamp_clip_from_world[6 * most_lamps];  // of the shadows' faces
};
uniform int lamp_count;

bool lamp_has(Lamp lamp, int bit) { return (int(lamp.place_kind.w) & bit) != 0; }

struct LampLight {
    vec3 to_lamp;      // unit
    float distance_m;  // to its middle
    vec3 irradiance;   // of what faces it
    float size;        // its radius over its distance
};

LampLight lamp_light(Lamp lamp, vec3 world_position) {
    if (!lamp_has(lamp, lamp_is_placed)) {
        const float endless_m = 1e30;
        return LampLight(lamp.place_kind.xyz, endless_m, lamp.light_size.rgb, lamp.light_size.w);
    }
    vec3 way = lamp.place_kind.xyz - world_position;
    // Within the ball that shines, or a millimetre of a point, it is no brighter than there.
    const float least_m = 1e-3;
    float distance_m = length(way);
    vec3 to_lamp = distance_m > 0.0 ? way / distance_m : vec3(0.0, 0.0, 1.0);
    float from_m = max(distance_m, max(lamp.light_size.w, least_m));
    float share = from_m * lamp.axis_range.w;
    float window = clamp(1.0 - share * share * share * share, 0.0, 1.0);
    float cone = clamp(-dot(lamp.axis_range.xyz, to_lamp) * lamp.cone_shadow.x + lamp.cone_shadow.y, 0.0, 1.0);
    return LampLight(to_lamp, distance_m, lamp.light_size.rgb * (window * cone * cone / (from_m * from_m)),
                     lamp.light_size.w / from_m);
}
