// The Utah teapot (Newell 1975).
#pragma once

#include "scene/model.h"

namespace matchlight {

/// Adds the pot: 1 long from handle to spout, the spout along +x, its axis the z axis, its middle height at z = 0.
/// Body, lid and bottom are closed; handle and spout are tubes that end in the body, the spout's mouth is open.
void add_teapot(ModelMesh& mesh);

}  // namespace matchlight
