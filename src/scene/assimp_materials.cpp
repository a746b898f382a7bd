// assimp's materials as metallic-roughness ones.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <fmt/format.h>

#include "scene/assimp_import.h"
#include "scene/texture_image.h"

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

class TextureSlots {
public:
    TextureSlots(const aiMaterial& material, const CheckedModel& checked, TextureTable& textures, Warnings& warnings)
        : material_(material), checked_(checked), textures_(textures), warnings_(warnings) {}

    /// The texture of a slot, or −1. The first one decides which texture coordinates the material uses.
    int texture(aiTextureType type, const char* what) {
        aiString name;
        unsigned set = 0;
        aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
        if (material_.GetTextureCount(type) == 0) return -1;
        if (material_.GetTexture(type, 0, &name, nullptr, &set, nullptr, nullptr, modes) != aiReturn_SUCCESS) return -1;
        if (set_ && *set_ != set) {
            warnings_.add(fmt::format("{}: the {} texture of material '{}' has its own texture coordinates, left out",
                                      checked_.path.string(), what, material_.GetName().C_Str()));
            return -1;
        }
        if (modes[0] == aiTextureMapMode_Mirror || modes[1] == aiTextureMapMode_Mirror) {
            warnings_.add(fmt::format("{}: the {} texture of material '{}' is repeated without mirroring",
                                      checked_.path.string(), what, material_.GetName().C_Str()));
        }
        const int index =
            textures_.index_of(name.C_Str(), modes[0] != aiTextureMapMode_Clamp, modes[1] != aiTextureMapMode_Clamp);
        if (index >= 0) set_ = set;
        return index;
    }
    unsigned set() const { return set_.value_or(0); }

private:
    const aiMaterial& material_;
    const CheckedModel& checked_;
    TextureTable& textures_;
    Warnings& warnings_;
    std::optional<unsigned> set_;
};

void translate_gltf(const aiMaterial& from, TextureSlots& slots, ModelMaterial& to) {
    to.metallic = unit(number_of(from, AI_MATKEY_METALLIC_FACTOR).value_or(1));
    to.roughness = unit(number_of(from, AI_MATKEY_ROUGHNESS_FACTOR).value_or(1));
    if (const auto base = color_of(from, AI_MATKEY_BASE_COLOR)) to.base_color = *base;
    if (const auto light = color_of(from, AI_MATKEY_COLOR_EMISSIVE))
        to.emissive = {(*light)[0], (*light)[1], (*light)[2]};

    to.base_color_texture = slots.texture(aiTextureType_BASE_COLOR, "base colour");
    to.normal_texture = slots.texture(aiTextureType_NORMALS, "normal");
    to.metallic_roughness_texture = slots.texture(aiTextureType_METALNESS, "metallic-roughness");
    to.emissive_texture = slots.texture(aiTextureType_EMISSIVE, "emissive");
    to.occlusion_texture = slots.texture(aiTextureType_LIGHTMAP, "occlusion");
    to.normal_scale = number_of(from, AI_MATKEY_GLTF_TEXTURE_SCALE(aiTextureType_NORMALS, 0)).value_or(1);
    to.occlusion_strength =
        unit(number_of(from, AI_MATKEY_GLTF_TEXTURE_STRENGTH(aiTextureType_LIGHTMAP, 0)).value_or(1));

    aiString mode;
    from.Get(AI_MATKEY_GLTF_ALPHAMODE, mode);
    if (mode == aiString("MASK")) to.alpha_mode = AlphaMode::mask;
    if (mode == aiString("BLEND")) to.alpha_mode = AlphaMode::blend;
    to.alpha_cutoff = number_of(from, AI_MATKEY_GLTF_ALPHACUTOFF).value_or(0.5f);
    int double_sided = 0;
    from.Get(AI_MATKEY_TWOSIDED, double_sided);
    to.double_sided = double_sided != 0;
}

/// The classic .mtl model in glTF's terms; colours are taken as scene-linear, as Blender writes them.
///  - `Pr`, `Pm` (the physically based extension) are roughness and metallic as they stand.
///  - Otherwise the exponent `Ns` gives roughness² = sqrt(2 / (Ns + 2)): the width of a Blinn-Phong lobe as that of a
///    microfacet distribution (Walter et al., Microfacet models for refraction through rough surfaces, 2007, eq. of
///    section 5.2; glTF's roughness is the square root of theirs).
///  - Metals have no diffuse light: black `Kd` with `Ks` above any dielectric's makes one of colour Ks.
///  - `d` below 1 blends.
void translate_mtl(const aiMaterial& from, TextureSlots& slots, ModelMaterial& to) {
    constexpr float black = 0.02f;
    constexpr float brightest_dielectric = 0.2f;  // diamond reflects 0.17 head on
    const auto largest = [](const std::array<float, 4>& c) { return std::max({c[0], c[1], c[2]}); };
    const auto diffuse = color_of(from, AI_MATKEY_COLOR_DIFFUSE).value_or(std::array{0.8f, 0.8f, 0.8f, 1.0f});
    const auto specular = color_of(from, AI_MATKEY_COLOR_SPECULAR).value_or(std::array{0.0f, 0.0f, 0.0f, 1.0f});
    to.base_color_texture = slots.texture(aiTextureType_DIFFUSE, "diffuse");
    to.normal_texture = slots.texture(aiTextureType_NORMALS, "normal");
    to.emissive_texture = slots.texture(aiTextureType_EMISSIVE, "emissive");

    const auto metallic = number_of(from, AI_MATKEY_METALLIC_FACTOR);
    const bool looks_metallic =
        to.base_color_texture < 0 && largest(diffuse) < black && largest(specular) > brightest_dielectric;
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

int TextureTable::index_of(const std::string& name, bool repeat_u, bool repeat_v) {
    const std::string key = fmt::format("{} {} {}", name, repeat_u, repeat_v);
    if (const auto found = known_.find(key); found != known_.end()) return found->second;
    int& index = known_[key] = -1;
    constexpr std::string_view prefix = "texture-";
    std::size_t number = checked_.textures.size();
    if (name.starts_with(prefix)) {
        std::from_chars(name.data() + prefix.size(), name.data() + name.size(), number);
    }
    if (number >= checked_.textures.size()) return index;
    const TextureSource& source = checked_.textures[number];
    if (auto pixels = read_texture(source, checked_.path, warnings_)) {
        index = static_cast<int>(model_.textures.size());
        model_.textures.push_back({source.name, std::move(*pixels), repeat_u, repeat_v});
    }
    return index;
}

ModelMaterial translated_material(const aiMaterial& material, const CheckedModel& checked, TextureTable& textures,
                                  Warnings& warnings, unsigned& uv_set) {
    ModelMaterial translated;
    translated.name = material.GetName().C_Str();
    TextureSlots slots(material, checked, textures, warnings);
    if (checked.entry.ends_with(".gltf")) {
        translate_gltf(material, slots, translated);
    } else if (checked.entry.ends_with(".obj")) {
        translate_mtl(material, slots, translated);
    } else {
        translated.base_color = {0.8f, 0.8f, 0.8f, 1};  // bare geometry: light grey
    }
    uv_set = slots.set();
    return translated;
}

}  // namespace matchlight
