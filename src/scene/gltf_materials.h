// Materials, textures and pictures of a glTF file.
#pragma once

#include <vector>

#include "core/warnings.h"
#include "scene/checked_model.h"
#include "scene/gltf_document.h"

namespace matchlight {

/// Writes the checked materials, textures and samplers into `clean`; picture number N is called "texture-N" there and
/// returned at that place. Throws InputError: values of a wrong type, indices out of range, pictures outside the
/// model's folder.
std::vector<TextureSource> add_gltf_materials(const GltfDocument& document, nlohmann::json& clean, Warnings& warnings);

}  // namespace matchlight
