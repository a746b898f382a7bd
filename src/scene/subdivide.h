// Splits long edges of a mesh, so that what is found at its vertices can vary over a large face.
#pragma once

#include <cstddef>

#include "scene/model.h"

namespace matchlight {

/// The mesh with every edge longer than `longest_edge_m` halved until none is left or the mesh would have more than
/// `most_vertices`; shape and shading stay the same. Whether an edge is split depends on its ends' places alone, so
/// faces that meet without sharing vertices still meet.
ModelMesh with_short_edges(const ModelMesh& mesh, double longest_edge_m, std::size_t most_vertices);

}  // namespace matchlight
