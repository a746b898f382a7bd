// From assimp's scene to a Model: node transforms applied, axes turned, materials translated.
#pragma once

#include "core/warnings.h"
#include "scene/checked_model.h"
#include "scene/model.h"

struct aiMaterial;

namespace matchlight {

/// Loads what the checks let through. Throws InputError.
Model import_model(const CheckedModel& checked, Warnings& warnings);

/// The pictures of a model, each decoded once for each way it is wrapped.
class TextureTable {
public:
    TextureTable(const CheckedModel& checked, Model& model, Warnings& warnings)
        : checked_(checked), model_(model), warnings_(warnings) {}

    /// Index into Model::textures of "texture-N"; −1 when it is missing or damaged.
    int index_of(const std::string& name, bool repeat_u, bool repeat_v);

private:
    const CheckedModel& checked_;
    Model& model_;
    Warnings& warnings_;
    std::map<std::string, int> known_;
};

/// A material of assimp's scene in glTF's terms. `uv_set` becomes the set of texture coordinates it uses.
ModelMaterial translated_material(const aiMaterial& material, const CheckedModel& checked, TextureTable& textures,
                                  Warnings& warnings, unsigned& uv_set);

}  // namespace matchlight
