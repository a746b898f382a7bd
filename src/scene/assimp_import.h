// From assimp's scene to a Model: node transforms applied, axes turned, materials translated.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/warnings.h"
#include "scene/checked_model.h"
#include "scene/model.h"

struct aiMaterial;

namespace matchlight {

/// Loads what the checks let through. Throws InputError.
Model import_model(const CheckedModel& checked, Warnings& warnings);

/// The pictures of a model, each decoded once for each way it is read.
class TextureTable {
public:
    TextureTable(const CheckedModel& checked, Model& model, Warnings& warnings)
        : checked_(checked), model_(model), warnings_(warnings) {}

    /// Index into Model::textures of a TextureSource; −1 when it is missing or damaged.
    int index_of(std::size_t source, const TextureSampling& sampling);

private:
    struct Known {
        std::size_t source = 0;
        TextureSampling sampling;
        int index = -1;
    };
    const CheckedModel& checked_;
    Model& model_;
    Warnings& warnings_;
    std::vector<Known> known_;
};

/// A material, and which of the file's texture coordinates its vertices keep.
struct ImportedMaterial {
    ModelMaterial material;
    unsigned first_set = 0;
    std::array<double, 6> first_rows{1, 0, 0, 0, 1, 0};  // times (u, v, 1) of the set: the vertices' first pair
    std::optional<unsigned> second_set;                  // their second pair
};

/// A material of the classic kinds in glTF's terms.
ImportedMaterial translated_material(const aiMaterial& material, const CheckedModel& checked, TextureTable& textures,
                                     Warnings& warnings);

/// A glTF material. Its first texture decides where the vertices' first pair lies; one that lies otherwise has a
/// mapping from there or, of other coordinates, takes the second pair. A third set is left out with a warning.
ImportedMaterial placed_material(const CheckedMaterial& material, const CheckedModel& checked, TextureTable& textures,
                                 Warnings& warnings);

}  // namespace matchlight
