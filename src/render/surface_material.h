// A model's materials and textures as shaders read them.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "gl/objects.h"
#include "gl/program.h"
#include "gl/shader_source.h"
#include "render/surface_overlay.h"
#include "scene/model.h"
#include "scene/scene_file.h"

namespace matchlight {

/// Factors and textures of a material, overrides already applied.
struct SurfaceMaterial {
    ModelMaterial factors;                                    // overrides of the scene applied
    std::array<const Texture2D*, material_slots> textures{};  // by MaterialSlot, or null
    ShaderDefines defines;  // what surface/surface.frag is to be compiled with for what plain materials do without
    Eigen::Vector3f classic_diffuse = Eigen::Vector3f::Zero();   // Od
    Eigen::Vector3f classic_specular = Eigen::Vector3f::Zero();  // Ks
    const Texture2D* sheen_table = nullptr;                      // where there is sheen
    const SurfaceOverlay* overlay = nullptr;                     // of the scene; null: nothing
    ClassicShading shading;
    bool is_classic = false;  // Od or Ks was chosen; reflection by sphere map is classic all the same

    /// Share of white light that it sends back, diffuse and mirrored together, by its factors.
    float reflectance() const;
    bool blends() const { return factors.alpha_mode == AlphaMode::blend; }
    bool transmits() const { return defines.contains("TRANSMISSION"); }
    /// Lays what the scene says over it; `chosen` outlives this.
    void set_overlay(const SurfaceOverlay* chosen);
    /// Sets the uniforms and binds the textures of common/material.glsl and the classic terms.
    void bind(Program& program) const;
    /// Of what plain materials have; the others have theirs from here on, those that are there.
    static constexpr GLuint plain_textures = 5;
    static constexpr GLuint first_layer_unit = 25;

private:
    void bind_shading(Program& program) const;
    void bind_layers(Program& program, GLuint free_unit) const;
};

/// How a texture is read: as sRGB, as numbers, or as normals with how far they differ (render/normal_levels.h).
enum class TextureContent { color, numbers, normals };

/// The textures of a model, each uploaded once for each way it is read.
class SurfaceTextures {
public:
    /// Texture `index` of the model, or null for −1. Throws InputError when it is larger than the driver takes.
    const Texture2D* texture(const Model& model, int index, TextureContent content);
    /// The same of one that was uploaded; null where it was not.
    const Texture2D* uploaded(int index, TextureContent content) const;
    /// The albedo of sheen, made when first asked for (render/sheen.h).
    const Texture2D* sheen_table();
    const Texture2D* made_sheen_table() const { return sheen_table_.get(); }

private:
    struct Entry {
        int index = 0;
        TextureContent content = TextureContent::numbers;
        std::unique_ptr<Texture2D> texture;
    };
    std::vector<Entry> entries_;
    std::unique_ptr<Texture2D> sheen_table_;
};

/// The material with what the scene sets in place of the model's values and their textures; Od and Ks aside.
ModelMaterial with_override(const ModelMaterial& material, const MaterialOverride& chosen);

/// `override_` on top of the model's material. Od and Ks of the classic model come from it or, where it has none, from
/// the metallic-roughness factors: Od = base colour · (1 − metallic), Ks = reflectance at normal incidence.
SurfaceMaterial make_surface_material(const Model& model, const ModelMaterial& material, const MaterialOverride& chosen,
                                      SurfaceTextures& textures);
/// The same where all its textures are uploaded already; nullopt where one is not.
std::optional<SurfaceMaterial> surface_material_of_uploaded(const ModelMaterial& material,
                                                            const MaterialOverride& chosen,
                                                            const SurfaceTextures& textures);

}  // namespace matchlight
