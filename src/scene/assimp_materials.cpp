// assimp's materials as metallic-roughness ones.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include <assimp/material.h>

#include "scene/assimp_import.h"

namespace matchlight {
namespace {

std::optional<float> number_of(const aiMaterial& material, const char* key, unsigned type, unsigned index) {
    float value = 0;
    if (material.Get(key, type, index, value) != aiReturn_SUCCESS || !std::isfinite(value)) return std::nullopt;
    return value;
}

std::optional<std::array<float, 4>> color_of(const aiMaterial& material, const char* key, unsigned type,
                                             unsigned index) {
    aiColor4D color(0, 0, 0, 1);
    if (material.Get(key, type, index, color) != aiReturn_SUCCESS) return std::nullopt;
    const std::array<float, 4> values{color.r, color.g, color.b, color.a};
    if (!std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); })) return std::nullopt;
    return values;
}

float unit(float value) {
    return std::clamp(value, 0.0f, 1.0f);
}

/// Of the names that the checks gave: "texture-3".
std::optional<std::size_t> number_behind(std::string_view prefix, const aiString& name) {
    const std::string_view text = name.C_Str();
    std::size_t number = 0;
    if (!text.starts_with(prefix) ||
        std::from_chars(text.data() + prefix.size(), text.data() + text.size(), number).ec != std::errc())
        return std::nullopt;
    return number;
}

/// The textures of a classic material, each in its slot.
void take_texture(const aiMaterial& from, aiTextureType type, MaterialSlot slot, TextureTable& textures,
                  ModelMaterial& to) {
    aiString name;
    aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    if (from.GetTextureCount(type) == 0 ||
        from.GetTexture(type, 0, &name, nullptr, nullptr, nullptr, nullptr, modes) != aiReturn_SUCCESS)
        return;
    const auto number = number_behind("texture-", name);
    if (!number) return;
    const auto wrap = [](aiTextureMapMode mode) {
        return mode == aiTextureMapMode_Clamp ? TextureWrap::clamp : TextureWrap::repeat;
    };
    TextureSampling sampling;
    sampling.wrap_u = wrap(modes[0]);
    sampling.wrap_v = wrap(modes[1]);
    to.texture(slot) = textures.index_of(*number, sampling);
}

/// The classic .mtl model in glTF's terms; colours are taken as scene-linear, as Blender writes them.
///  - `Pr`, `Pm` (the physically based extension) are roughness and metallic as they stand.
///  - Otherwise the exponent `Ns` gives roughness² = sqrt(2 / (Ns + 2)): the width of a Blinn-Phong lobe as that of a
///    microfacet distribution (Walter et al., Microfacet models for refraction through rough surfaces, 2007, eq. of
///    section 5.2; glTF's roughness is the square root of theirs).
///  - Metals have no diffuse light: black `Kd` with `Ks` above any dielectric's makes one of colour Ks.
///  - `d` below 1 blends.
void translate_mtl(const aiMaterial& from, TextureTable& textures, ModelMaterial& to) {
    constexpr float black = 0.02f;
    constexpr float brightest_dielectric = 0.2f;  // diamond reflects 0.17 head on
    const auto largest = [](const std::array<float, 4>& c) { return std::max({c[0], c[1], c[2]}); };
    const auto diffuse = color_of(from, AI_MATKEY_COLOR_DIFFUSE).value_or(std::array{0.8f, 0.8f, 0.8f, 1.0f});
    const auto specular = color_of(from, AI_MATKEY_COLOR_SPECULAR).value_or(std::array{0.0f, 0.0f, 0.0f, 1.0f});
    take_texture(from, aiTextureType_DIFFUSE, MaterialSlot::base_color, textures, to);
    take_texture(from, aiTextureType_NORMALS, MaterialSlot::normal, textures, to);
    take_texture(from, aiTextureType_EMISSIVE, MaterialSlot::emissive, textures, to);

    const auto metallic = number_of(from, AI_MATKEY_METALLIC_FACTOR);
    const bool looks_metallic = to.texture(MaterialSlot::base_color) < 0 && largest(diffuse) < black &&
                                largest(specular) > brightest_dielectric;
    to.metallic = unit(metallic.value_or(looks_metallic ? 1.0f : 0.0f));
    const auto& base = !metallic && looks_metallic ? specular : diffuse;
    for (std::size_t c = 0; c < 3; ++c) to.base_color[c] = unit(base[c]);

    const float exponent = std::max(number_of(from, AI_MATKEY_SHININESS).value_or(0), 0.0f);
    const float from_exponent = std::pow(2.0f / (exponent + 2.0f), 0.25f);
    to.roughness = unit(number_of(from, AI_MATKEY_ROUGHNESS_FACTOR).value_or(from_exponent));
    if (const auto light = color_of(from, AI_MATKEY_COLOR_EMISSIVE)) {
        for (std::size_t c = 0; c < 3; ++c) to.emissive[c] = std::max((*light)[c], 0.0f);
    }
    to.base_color[3] = unit(number_of(from, AI_MATKEY_OPACITY).value_or(1));
    if (to.base_color[3] < 1) to.alpha_mode = AlphaMode::blend;
}

}  // namespace

ImportedMaterial translated_material(const aiMaterial& material, const CheckedModel& checked, TextureTable& textures,
                                     Warnings& warnings) {
    aiString name;
    material.Get(AI_MATKEY_NAME, name);
    ImportedMaterial translated;
    if (checked.entry.ends_with(".gltf")) {
        const auto number = number_behind("material-", name);
        if (number && *number < checked.materials.size())
            return placed_material(checked.materials[*number], checked, textures, warnings);
        translated.material.metallic = translated.material.roughness = 1;  // of what has none: glTF's default
        return translated;
    }
    translated.material.name = name.C_Str();
    if (checked.entry.ends_with(".obj")) {
        translate_mtl(material, textures, translated.material);
    } else {
        translated.material.base_color = {0.8f, 0.8f, 0.8f, 1};  // bare geometry: light grey
    }
    return translated;
}

}  // namespace matchlight
