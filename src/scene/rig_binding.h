// Ties flattened meshes to the nodes that move them.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "scene/checked_model.h"

namespace matchlight {

/// What moves a mesh that a node shows, by their names; still without vertices. nullopt where nothing does.
std::optional<MeshBinding> binding_of(const CheckedRig& rig, const std::string& node, const std::string& mesh);

/// Puts the vertices' numbers in the place of their colours, which it returns: whatever is welded, split and left out
/// afterwards, each vertex knows which of the file it was.
std::vector<std::array<float, 4>> number_vertices(ModelMesh& mesh);

/// Gives such a mesh its colours back, and the binding its vertices. `primitive` is null where they do not move against
/// each other.
void bind_vertices(ModelMesh& mesh, const std::vector<std::array<float, 4>>& colors, const CheckedPrimitive* primitive,
                   MeshBinding& binding);

/// The model's rig, its meshes wound and placed for the pose at rest.
void rest_in_pose(Model& model, const CheckedRig& rig, std::vector<MeshBinding> bindings);

}  // namespace matchlight
