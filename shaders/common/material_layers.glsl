// What a glTF material may have above metallic-roughness. Each part is there where its definition is, so that materials
// without it pay nothing. Include common/material.glsl before.
const int has_coat = 32, has_coat_roughness = 64, has_coat_normal = 128, has_sheen_color = 256,
          has_sheen_roughness = 512, has_specular = 1024, has_specular_color = 2048, has_anisotropy = 4096,
          has_transmission = 8192, has_thickness = 16384;

#ifdef COAT  // KHR_materials_clearcoat
uniform float coat_strength, coat_roughness_factor, coat_normal_scale;
uniform sampler2D coat_texture;            // R
uniform sampler2D coat_roughness_texture;  // G
uniform sampler2D coat_normal_texture;

float coat_strength_at(vec2 uv) {
    float strength = coat_strength;
    if ((material_textures & has_coat) != 0) strength *= sampled(coat_texture, uv_of(has_coat, uv)).r;
    return clamp(strength, 0.0, 1.0);
}
float coat_roughness_at(vec2 uv) {
    float roughness = coat_roughness_factor;
    if ((material_textures & has_coat_roughness) != 0)
        roughness *= sampled(coat_roughness_texture, uv_of(has_coat_roughness, uv)).g;
    return clamp(roughness, 0.0, 1.0);
}
// The coat lies over the base's normal map, and may have one of its own.
vec3 coat_normal(vec3 normal, vec4 tangent, vec2 uv, bool front_facing, out float slope_variance) {
    return normal_by(has_coat_normal, coat_normal_texture, coat_normal_scale, normal, tangent, uv, front_facing, slope_variance);
}
#endif

#ifdef SHEEN  // KHR_materials_sheen
uniform vec3 sheen_color_factor;
uniform float sheen_roughness_factor;
uniform sampler2D sheen_color_texture;      // sRGB
uniform sampler2D sheen_roughness_texture;  // A
uniform sampler2D sheen_albedo_table;       // by the cosine and the roughness (render/sheen.h)

vec3 sheen_color_at(vec2 uv) {
    vec3 color = sheen_color_factor;
    if ((material_textures & has_sheen_color) != 0) color *= sampled(sheen_color_texture, uv_of(has_sheen_color, uv)).rgb;
    return clamp(color, 0.0, 1.0);
}
float sheen_roughness_at(vec2 uv) {
    float roughness = sheen_roughness_factor;
    if ((material_textures & has_sheen_roughness) != 0)
        roughness *= sampled(sheen_roughness_texture, uv_of(has_sheen_roughness, uv)).a;
    return clamp(roughness, 0.0, 1.0);
}
float sheen_albedo(float cosine, float roughness) {
    // Texels hold their own middles: the table's edge is the function's.
    vec2 size = vec2(textureSize(sheen_albedo_table, 0));
    return textureLod(sheen_albedo_table, (vec2(cosine, roughness) * (size - 1.0) + 0.5) / size, 0.0).r;
}
// How fibres that stand up send light from one direction to another, but for a factor (Estevez & Kulla 2017, "Production
// Friendly Microfacet Sheen BRDF", with the visibility of Neubelt & Pettineo 2013, "Crafting a Next-Gen Material Pipeline
// for The Order: 1886"); about z = the normal.
float sheen_distribution(vec3 eye, vec3 light, float roughness) {
    float inverse = 1.0 / max(roughness * roughness, 1e-3);
    vec3 h = normalize(eye + light);
    float sine2 = max(1.0 - h.z * h.z, 1e-4);
    return pow(sine2, 0.5 * inverse) / (eye.z + light.z - eye.z * light.z);
}
#endif

#ifdef SPECULAR  // KHR_materials_specular and KHR_materials_ior
uniform float specular_strength;
uniform vec3 specular_color_factor;
uniform float ior_reflectance;              // head on
uniform sampler2D specular_texture;         // A
uniform sampler2D specular_color_texture;   // sRGB

// What the dielectric reflects head on, and edge on in a.
vec4 specular_at(vec2 uv) {
    float strength = specular_strength;
    vec3 color = specular_color_factor;
    if ((material_textures & has_specular) != 0) strength *= sampled(specular_texture, uv_of(has_specular, uv)).a;
    if ((material_textures & has_specular_color) != 0)
        color *= sampled(specular_color_texture, uv_of(has_specular_color, uv)).rgb;
    strength = clamp(strength, 0.0, 1.0);
    return vec4(min(ior_reflectance * max(color, vec3(0.0)), vec3(1.0)) * strength, strength);
}
#endif

#ifdef ANISOTROPY  // KHR_materials_anisotropy
uniform float anisotropy_strength;
uniform vec2 anisotropy_direction;     // of the tangent's plane
uniform sampler2D anisotropy_texture;  // RG direction, B strength

struct Anisotropy {
    vec3 along;   // the direction in which the lobe is widest, in the surface
    float alpha;  // there; across it that of the roughness
};
Anisotropy anisotropy_at(vec2 uv, vec3 n, vec4 tangent, bool front_facing, float roughness) {
    vec2 direction = anisotropy_direction;
    float strength = anisotropy_strength;
    if ((material_textures & has_anisotropy) != 0) {
        vec3 texel = sampled(anisotropy_texture, uv_of(has_anisotropy, uv)).rgb;
        vec2 drawn = texel.rg * 2.0 - 1.0;
        direction = mat2(direction, vec2(-direction.y, direction.x)) * drawn;
        strength *= texel.b;
    }
    float alpha = roughness * roughness;
    vec3 t = tangent.xyz - dot(tangent.xyz, n) * n;
    float length2 = dot(t, t);
    // Without tangents there is no direction to be wider in.
    if (length2 < 1e-12 || dot(direction, direction) < 1e-12) return Anisotropy(vec3(0.0), alpha);
    t *= inversesqrt(length2);
    vec3 b = cross(front_facing ? n : -n, t) * tangent.w;
    return Anisotropy(normalize(direction.x * t + direction.y * b), mix(alpha, 1.0, strength * strength));
}
#endif

#ifdef TRANSMISSION  // KHR_materials_transmission and KHR_materials_volume
uniform float transmission_factor, thickness_factor, refractive_index;
uniform vec3 absorbed_per_unit;          // of thickness
uniform sampler2D transmission_texture;  // R
uniform sampler2D thickness_texture;     // G

float transmission_at(vec2 uv) {
    float strength = transmission_factor;
    if ((material_textures & has_transmission) != 0)
        strength *= sampled(transmission_texture, uv_of(has_transmission, uv)).r;
    return clamp(strength, 0.0, 1.0);
}
// In the mesh's own units; 0: a thin wall.
float thickness_at(vec2 uv) {
    float thickness = thickness_factor;
    if ((material_textures & has_thickness) != 0) thickness *= sampled(thickness_texture, uv_of(has_thickness, uv)).g;
    return max(thickness, 0.0);
}
#endif
