// Animations, skins and morph targets of a glTF file.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "core/warnings.h"
#include "scene/checked_model.h"
#include "scene/gltf_accessors.h"
#include "scene/gltf_document.h"

namespace matchlight {

/// Whether a file has anything that read_gltf_rig would read.
bool has_gltf_rig(const GltfDocument& document);

/// A primitive that is loaded: its place in the file, and the name that its mesh will have.
struct LoadedPrimitive {
    std::size_t mesh = 0, primitive = 0;
    std::string name;
};

/// What moves in the file; null where nothing can. Throws InputError: indices out of range, times that do not ascend,
/// values that are not finite, counts that do not belong together, sizes beyond the memory there is.
std::shared_ptr<const CheckedRig> read_gltf_rig(const GltfDocument& document, const GltfAccessors& accessors,
                                                const std::vector<LoadedPrimitive>& primitives, Warnings& warnings);

}  // namespace matchlight
