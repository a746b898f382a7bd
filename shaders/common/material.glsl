// A glTF 2.0 metallic-roughness material: factors, textures and the normal they give a fragment.
// Bits of `material_textures`, by MaterialSlot (scene/model.h).
const int has_base_color = 1, has_metallic_roughness = 2, has_normal = 4, has_occlusion = 8, has_emissive = 16;

layout(binding = 0) uniform sampler2D base_color_texture;          // sRGB
layout(binding = 1) uniform sampler2D metallic_roughness_texture;  // G roughness, B metallic
layout(binding = 2) uniform sampler2D normal_texture;
layout(binding = 3) uniform sampler2D occlusion_texture;  // R
layout(binding = 4) uniform sampler2D emissive_texture;   // sRGB

uniform int material_textures = 0;
uniform vec4 base_color_factor = vec4(1.0);
uniform float metallic_factor = 0.0;
uniform float roughness_factor = 0.5;
uniform vec3 emissive_factor = vec3(0.0);
uniform float normal_scale = 1.0;
uniform float occlusion_strength = 1.0;
uniform float alpha_cutoff = 0.0;   // fragments with less are left out
uniform bool alpha_blends = false;  // else what is left is opaque

#ifdef RELIEF
// Of the flat surface: what is seen moves by jumps.
vec2 relief_uv_dx, relief_uv_dy;
#define sampled(map, uv) textureGrad(map, uv, relief_uv_dx, relief_uv_dy)
#else
#define sampled(map, uv) texture(map, uv)
#endif

// Where a texture is read; the base colour's lies as the vertices say (scene/placed_material.cpp).
#ifdef UV_MAPPINGS
in vec2 material_uv_second;
uniform vec3 uv_rows[30];             // two a slot
uniform int slots_of_second_uv = 0;   // by the same bits
vec2 uv_of(int bit, vec2 uv) {
    int slot = findLSB(bit);
    vec3 from = vec3((slots_of_second_uv & bit) != 0 ? material_uv_second : uv, 1.0);
    return vec2(dot(uv_rows[2 * slot], from), dot(uv_rows[2 * slot + 1], from));
}
#else
#define uv_of(bit, uv) uv
#endif

vec4 base_color_at(vec2 uv, vec4 vertex_color) {
    vec4 color = base_color_factor * vertex_color;
    if ((material_textures & has_base_color) != 0) color *= sampled(base_color_texture, uv);
    return color;
}

vec2 metallic_roughness_at(vec2 uv) {
    vec2 value = vec2(metallic_factor, roughness_factor);
    if ((material_textures & has_metallic_roughness) != 0) value *= sampled(metallic_roughness_texture, uv_of(has_metallic_roughness, uv)).bg;
    return clamp(value, 0.0, 1.0);
}

vec3 emissive_at(vec2 uv) {
    vec3 emissive = emissive_factor;
    if ((material_textures & has_emissive) != 0) emissive *= sampled(emissive_texture, uv_of(has_emissive, uv)).rgb;
    return emissive;
}

float occlusion_at(vec2 uv) {
    if ((material_textures & has_occlusion) == 0) return 1.0;
    return 1.0 + occlusion_strength * (sampled(occlusion_texture, uv_of(has_occlusion, uv)).r - 1.0);
}

// The normal that a map gives, or the surface's where the material has none, on the side the eye sees. `tangent` is zero
// where the model has none. `slope_variance`: of the slopes within a texel of the map's level (render/normal_levels.h).
vec3 normal_by(int bit, sampler2D map, float scale, vec3 normal, vec4 tangent, vec2 uv, bool front_facing,
               out float slope_variance) {
    vec3 n = normalize(normal);
    slope_variance = 0.0;
    if ((material_textures & bit) != 0 && dot(tangent.xyz, tangent.xyz) > 0.0) {
        vec3 t = normalize(tangent.xyz - dot(tangent.xyz, n) * n);
        vec3 b = cross(n, t) * tangent.w;
        vec4 texel = sampled(map, uv_of(bit, uv));
        vec3 mapped = texel.xyz * 2.0 - 1.0;
        float slope_deviation = scale * texel.a / max(mapped.z, 0.1);
        slope_variance = slope_deviation * slope_deviation;
        mapped.xy *= scale;
        n = normalize(mat3(t, b, n) * mapped);
    }
    return front_facing ? n : -n;
}

vec3 shading_normal(vec3 normal, vec4 tangent, vec2 uv, bool front_facing, out float slope_variance) {
    return normal_by(has_normal, normal_texture, normal_scale, normal, tangent, uv, front_facing, slope_variance);
}

// As wide as facets and what the map's normals differ by are together: α² is twice the variance of slopes along one axis
// (Toksvig 2005, "Mipmapping Normal Maps"; Olano & Baker 2010, "LEAN Mapping").
float roughness_with(float roughness, float slope_variance) {
    return slope_variance > 0.0 ? min(sqrt(sqrt(pow(roughness, 4.0) + slope_variance)), 1.0) : roughness;
}
