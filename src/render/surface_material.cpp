// Uploads textures, binds materials.
#include "render/surface_material.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/transfer.h"
#include "gl/context.h"
#include "render/normal_levels.h"
#include "render/sheen.h"

namespace matchlight {

float SurfaceMaterial::reflectance() const {
    const auto& base = factors.base_color;
    const double luminance = luminance_rec709(base[0], base[1], base[2]);
    constexpr double dielectric = 0.04;  // glTF 2.0, appendix B
    return static_cast<float>(std::clamp(luminance + dielectric * (1 - factors.metallic), 0.0, 1.0));
}

void SurfaceMaterial::set_overlay(const SurfaceOverlay* chosen) {
    overlay = chosen;
    if (overlay != nullptr) defines.insert(overlay->defines().begin(), overlay->defines().end());
}

void SurfaceMaterial::bind(Program& program) const {
    static constexpr std::array<const char*, material_slots> samplers{
        "base_color_texture",      "metallic_roughness_texture", "normal_texture",
        "occlusion_texture",       "emissive_texture",           "coat_texture",
        "coat_roughness_texture",  "coat_normal_texture",        "sheen_color_texture",
        "sheen_roughness_texture", "specular_texture",           "specular_color_texture",
        "anisotropy_texture",      "transmission_texture",       "thickness_texture"};
    int present = 0;
    GLuint layer_unit = first_layer_unit;
    for (std::size_t i = 0; i < textures.size(); ++i) {
        if (!textures[i]) continue;
        const bool is_plain = i < plain_textures;
        program.bind_texture(samplers[i], is_plain ? static_cast<GLuint>(i) : layer_unit++, *textures[i]);
        present |= 1 << i;
    }
    program.set("material_textures", present);
    program.set("base_color_factor", Eigen::Vector4f(factors.base_color.data()));
    program.set("metallic_factor", factors.metallic);
    program.set("roughness_factor", factors.roughness);
    program.set("emissive_factor", Eigen::Vector3f(factors.emissive.data()));
    program.set("normal_scale", factors.normal_scale);
    program.set("occlusion_strength", factors.occlusion_strength);
    program.set("alpha_cutoff", factors.alpha_mode == AlphaMode::mask ? factors.alpha_cutoff : 0.0F);
    program.set("alpha_blends", blends());
    program.set("classic_diffuse", classic_diffuse);
    program.set("classic_specular", classic_specular);
    program.set("is_classic", is_classic);
    bind_shading(program);
    bind_layers(program, layer_unit);
    if (overlay != nullptr) overlay->bind(program);
    if (!defines.contains("UV_MAPPINGS")) return;
    std::array<Eigen::Vector3f, 2 * material_slots> rows;
    int of_second = 0;
    for (std::size_t i = 0; i < material_slots; ++i) {
        const UvMapping& mapping = factors.textures[i].mapping;
        rows[2 * i] = Eigen::Vector3f(mapping.rows.data());
        rows[2 * i + 1] = Eigen::Vector3f(mapping.rows.data() + 3);
        if (mapping.of_second) of_second |= 1 << i;
    }
    program.set("uv_rows", std::span<const Eigen::Vector3f>(rows));
    program.set("slots_of_second_uv", of_second);
}

void SurfaceMaterial::bind_shading(Program& program) const {
    program.set("shading_model", static_cast<int>(shading.model));
    if (shading.model == ShadingModel::physical) return;
    const auto vector = [](const std::array<double, 3>& color) {
        return Eigen::Vector3f(Eigen::Vector3d(color.data()).cast<float>());
    };
    program.set("shininess", shading.shininess);
    program.set("tones", shading.tones);
    program.set("cool_color", vector(shading.cool));
    program.set("warm_color", vector(shading.warm));
    program.set("cool_warm_share",
                Eigen::Vector2f(Eigen::Vector2d(shading.cool_share, shading.warm_share).cast<float>()));
}

void SurfaceMaterial::bind_layers(Program& program, GLuint free_unit) const {
    if (factors.coat) {
        program.set("coat_strength", factors.coat->strength);
        program.set("coat_roughness_factor", factors.coat->roughness);
        program.set("coat_normal_scale", factors.coat->normal_scale);
    }
    if (sheen_table != nullptr) {
        program.set("sheen_color_factor", Eigen::Vector3f(factors.sheen->color.data()));
        program.set("sheen_roughness_factor", factors.sheen->roughness);
        program.bind_texture("sheen_albedo_table", free_unit, *sheen_table);
    }
    if (defines.contains("SPECULAR")) {
        const SpecularFactors specular = factors.specular.value_or(SpecularFactors{});
        program.set("specular_strength", specular.strength);
        program.set("specular_color_factor", Eigen::Vector3f(specular.color.data()));
        const double ratio = (static_cast<double>(factors.ior) - 1) / (static_cast<double>(factors.ior) + 1);
        // glTF: an index of 0 stands for what reflects everything.
        program.set("ior_reflectance", factors.ior == 0 ? 1.0 : ratio * ratio);
    }
    if (transmits()) {
        const TransmissionFactors& transmission = *factors.transmission;
        program.set("transmission_factor", transmission.strength);
        program.set("thickness_factor", transmission.thickness);
        // Of what has no volume, or is a metal's index, the light goes straight on.
        program.set("refractive_index", factors.ior < 1 ? 1.0F : factors.ior);
        Eigen::Vector3f absorbed_per_unit = Eigen::Vector3f::Zero();
        if (std::isfinite(transmission.attenuation_distance)) {
            // Black stands for what no code value shows.
            constexpr float darkest = 1e-6F;
            for (std::size_t c = 0; c < 3; ++c) {
                absorbed_per_unit[static_cast<Eigen::Index>(c)] =
                    -std::log(std::max(transmission.attenuation_color[c], darkest)) / transmission.attenuation_distance;
            }
        }
        program.set("absorbed_per_unit", absorbed_per_unit);
    }
    if (factors.anisotropy) {
        const float rotation = factors.anisotropy->rotation_rad;
        program.set("anisotropy_strength", factors.anisotropy->strength);
        program.set("anisotropy_direction", Eigen::Vector2f(std::cos(rotation), std::sin(rotation)));
    }
}

namespace {

Wrap wrap_of(TextureWrap wrap) {
    switch (wrap) {
        case TextureWrap::clamp:
            return Wrap::clamp_to_edge;
        case TextureWrap::mirror:
            return Wrap::mirrored_repeat;
        default:
            return Wrap::repeat;
    }
}

TextureFilter filter_of(const TextureSampling& sampling) {
    TextureFilter filter{.is_smooth_near = sampling.is_smooth_near,
                         .is_smooth_far = sampling.is_smooth_far,
                         .anisotropy = static_cast<float>(sampling.anisotropy)};
    if (sampling.mipmaps == TextureMipmaps::none) filter.mipmaps = Mipmaps::none;
    if (sampling.mipmaps == TextureMipmaps::nearest) filter.mipmaps = Mipmaps::nearest;
    return filter;
}

/// What the material has that plain ones have not.
ShaderDefines defines_of(const ModelMaterial& material) {
    ShaderDefines defines;
    for (const TextureUse& use : material.textures) {
        if (use.index >= 0 && !use.mapping.is_plain()) defines["UV_MAPPINGS"] = "1";
    }
    if (material.unlit) {
        defines["UNLIT"] = "1";
        return defines;
    }
    constexpr float usual_ior = 1.5F;  // reflects 0.04
    if (material.coat && material.coat->strength > 0) defines["COAT"] = "1";
    if (material.sheen && *std::ranges::max_element(material.sheen->color) > 0) defines["SHEEN"] = "1";
    if (material.specular || material.ior != usual_ior) defines["SPECULAR"] = "1";
    if (material.anisotropy && material.anisotropy->strength > 0) defines["ANISOTROPY"] = "1";
    if (material.transmission && material.transmission->strength > 0) defines["TRANSMISSION"] = "1";
    return defines;
}

}  // namespace

const Texture2D* SurfaceTextures::uploaded(int index, TextureContent content) const {
    const auto known = std::ranges::find_if(
        entries_, [&](const Entry& entry) { return entry.index == index && entry.content == content; });
    return known != entries_.end() ? known->texture.get() : nullptr;
}

const Texture2D* SurfaceTextures::texture(const Model& model, int index, TextureContent content) {
    if (index < 0) return nullptr;
    if (const Texture2D* known = uploaded(index, content)) return known;
    const ModelTexture& source = model.textures.at(static_cast<std::size_t>(index));
    const Image8& image = source.rgba;
    const int largest = current_gl_context()->info().max_texture_size;
    if (image.width() > largest || image.height() > largest) {
        throw InputError(source.name, fmt::format("the texture has {}×{} pixels; this OpenGL driver takes {}",
                                                  image.width(), image.height(), largest));
    }
    const GLenum format = content == TextureContent::color ? GL_SRGB8_ALPHA8 : GL_RGBA8;
    auto texture = std::make_unique<Texture2D>(
        TextureShape{.format = format, .width = image.width(), .height = image.height(), .levels = 0});
    if (content == TextureContent::normals) {
        int level = 0;
        for (const Image8& normals : normal_levels(image))
            texture->upload(normals.bounds(), normals.samples(), level++);
    } else {
        texture->upload(image);
        texture->make_mipmaps();
    }
    texture->set_filter(filter_of(source.sampling));
    texture->set_wrap(wrap_of(source.sampling.wrap_u), wrap_of(source.sampling.wrap_v));
    entries_.push_back({index, content, std::move(texture)});
    return entries_.back().texture.get();
}

const Texture2D* SurfaceTextures::sheen_table() {
    if (!sheen_table_) {
        constexpr int size = 32, steps = 48;
        const ImageF table = sheen_albedo_table(size, steps);
        sheen_table_ = std::make_unique<Texture2D>(TextureShape{.format = GL_R32F, .width = size, .height = size});
        sheen_table_->upload(table);
        sheen_table_->set_filter(Filter::linear);
    }
    return sheen_table_.get();
}

namespace {

std::array<float, 3> to_float(const std::array<double, 3>& value) {
    return {static_cast<float>(value[0]), static_cast<float>(value[1]), static_cast<float>(value[2])};
}

}  // namespace

ModelMaterial with_override(const ModelMaterial& material, const MaterialOverride& chosen) {
    ModelMaterial factors = material;
    // A value the scene sets replaces the model's, its texture included.
    if (chosen.base_color) {
        const auto rgb = to_float(*chosen.base_color);
        std::copy(rgb.begin(), rgb.end(), factors.base_color.begin());
        if (chosen.texture.empty()) factors.texture(MaterialSlot::base_color) = -1;
    }
    if (chosen.metallic || chosen.roughness) {
        factors.metallic = static_cast<float>(chosen.metallic.value_or(factors.metallic));
        factors.roughness = static_cast<float>(chosen.roughness.value_or(factors.roughness));
        factors.texture(MaterialSlot::metallic_roughness) = -1;
    }
    if (chosen.emissive) {
        factors.emissive = to_float(*chosen.emissive);
        factors.texture(MaterialSlot::emissive) = -1;
    }
    return factors;
}

namespace {

TextureContent content_of(MaterialSlot slot) {
    if (slot == MaterialSlot::normal || slot == MaterialSlot::coat_normal) return TextureContent::normals;
    return is_color(slot) ? TextureContent::color : TextureContent::numbers;
}

/// `texture_of(index, content)` of each texture that is left of the model's.
template <class TextureOf>
SurfaceMaterial surface_material(const ModelMaterial& material, const MaterialOverride& chosen,
                                 const TextureOf& texture_of) {
    SurfaceMaterial result;
    result.factors = with_override(material, chosen);
    const ModelMaterial& factors = result.factors;
    for (std::size_t i = 0; i < material_slots; ++i) {
        result.textures[i] = texture_of(factors.textures[i].index, content_of(static_cast<MaterialSlot>(i)));
    }
    result.shading = chosen.shading;
    result.defines = defines_of(factors);
    if (chosen.shading.model != ShadingModel::physical) {
        // Nothing lies over the drawing, and it lets nothing through.
        for (const char* layer : {"COAT", "SHEEN", "SPECULAR", "ANISOTROPY", "TRANSMISSION", "UNLIT"})
            result.defines.erase(layer);
        result.defines["CLASSIC_SHADING"] = "1";
    }
    const Eigen::Vector3f base(factors.base_color.data());
    constexpr float dielectric_reflectance = 0.04F;  // glTF 2.0, appendix B
    const Eigen::Vector3f reflectance =
        Eigen::Vector3f::Constant(dielectric_reflectance * (1 - factors.metallic)) + factors.metallic * base;
    result.classic_diffuse = chosen.diffuse ? Eigen::Vector3f(to_float(*chosen.diffuse).data())
                                            : Eigen::Vector3f((1 - factors.metallic) * base);
    result.is_classic = chosen.diffuse || chosen.specular;
    result.classic_specular = chosen.specular ? Eigen::Vector3f(to_float(*chosen.specular).data()) : reflectance;
    return result;
}

}  // namespace

SurfaceMaterial make_surface_material(const Model& model, const ModelMaterial& material, const MaterialOverride& chosen,
                                      SurfaceTextures& textures) {
    SurfaceMaterial result = surface_material(
        material, chosen, [&](int index, TextureContent content) { return textures.texture(model, index, content); });
    if (result.defines.contains("SHEEN")) result.sheen_table = textures.sheen_table();
    return result;
}

std::optional<SurfaceMaterial> surface_material_of_uploaded(const ModelMaterial& material,
                                                            const MaterialOverride& chosen,
                                                            const SurfaceTextures& textures) {
    bool all_there = true;
    SurfaceMaterial result = surface_material(material, chosen, [&](int index, TextureContent content) {
        const Texture2D* texture = textures.uploaded(index, content);
        all_there = all_there && (index < 0 || texture != nullptr);
        return texture;
    });
    if (result.defines.contains("SHEEN")) result.sheen_table = textures.made_sheen_table();
    return all_there ? std::optional(std::move(result)) : std::nullopt;
}

}  // namespace matchlight
