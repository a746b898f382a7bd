// Analytic lights of a glTF file: KHR_lights_punctual.
#pragma once

#include <vector>

#include "scene/gltf_document.h"
#include "scene/model.h"

namespace matchlight {

/// The lights that nodes hold, in the nodes' order, with their places at rest in world axes (z up). The nodes are
/// checked: no cycle, indices in range. Throws InputError: an unknown type, values out of the extension's range.
std::vector<ModelLamp> read_gltf_lights(const GltfDocument& document);

}  // namespace matchlight
