// Materials, textures and pictures of a glTF file.
#pragma once

#include <vector>

#include "core/warnings.h"
#include "scene/checked_model.h"
#include "scene/gltf_document.h"

namespace matchlight {

/// Fills the materials and pictures of `checked`. Throws InputError: values of a wrong type, indices out of range,
/// pictures outside the model's folder.
void add_gltf_materials(const GltfDocument& document, CheckedModel& checked, Warnings& warnings);

}  // namespace matchlight
