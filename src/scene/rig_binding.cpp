// Numbers vertices, gathers what they hang on, poses them once.
#include "scene/rig_binding.h"

#include <charconv>
#include <utility>

#include "scene/model_pose.h"

namespace matchlight {
namespace {

/// Floats hold whole numbers exactly up to 2^24, and there may be 2^28 vertices.
constexpr std::uint32_t numbers_a_float = 1U << 16;

std::size_t vertex_number(const ModelVertex& vertex) {
    return static_cast<std::size_t>(vertex.color[0]) + numbers_a_float * static_cast<std::size_t>(vertex.color[1]);
}

std::vector<Eigen::Vector3f> gathered(const std::vector<Eigen::Vector3f>& of_file, const ModelMesh& mesh) {
    std::vector<Eigen::Vector3f> result;
    if (of_file.empty()) return result;
    result.reserve(mesh.vertices.size());
    for (const ModelVertex& vertex : mesh.vertices) result.push_back(of_file[vertex_number(vertex)]);
    return result;
}

}  // namespace

std::optional<MeshBinding> binding_of(const CheckedRig& rig, const std::string& node, const std::string& mesh) {
    const std::string_view prefix = "node-";
    std::size_t number = rig.rig.nodes.size();
    if (node.starts_with(prefix)) std::from_chars(node.data() + prefix.size(), node.data() + node.size(), number);
    if (number >= rig.rig.nodes.size()) return std::nullopt;  // the loader's own root
    const auto primitive = rig.primitives.find(mesh);
    const bool has_targets = primitive != rig.primitives.end() && !primitive->second.targets.empty();
    const bool has_skin = primitive != rig.primitives.end() && primitive->second.influences > 0 && rig.skins[number];
    if (!has_targets && !has_skin && !rig.moves[number]) return std::nullopt;
    MeshBinding binding;
    binding.node = number;
    if (has_skin) binding.skin = rig.skins[number];
    return binding;
}

std::vector<std::array<float, 4>> number_vertices(ModelMesh& mesh) {
    std::vector<std::array<float, 4>> colors;
    colors.reserve(mesh.vertices.size());
    for (ModelVertex& vertex : mesh.vertices) {
        const auto number = static_cast<std::uint32_t>(colors.size());
        const std::uint32_t low = number % numbers_a_float, high = number / numbers_a_float;
        colors.push_back(vertex.color);
        vertex.color = {static_cast<float>(low), static_cast<float>(high), 0, 0};
    }
    return colors;
}

void bind_vertices(ModelMesh& mesh, const std::vector<std::array<float, 4>>& colors, const CheckedPrimitive* primitive,
                   MeshBinding& binding) {
    if (primitive != nullptr) {
        for (const MorphTarget& target : primitive->targets) {
            binding.targets.push_back({.positions = gathered(target.positions, mesh),
                                       .normals = gathered(target.normals, mesh),
                                       .tangents = gathered(target.tangents, mesh)});
        }
        if (binding.skin) binding.influences = primitive->influences;
    }
    for (ModelVertex& vertex : mesh.vertices) {
        const std::size_t number = vertex_number(vertex);
        vertex.color = colors[number];
        binding.vertices.push_back({.position = Eigen::Vector3f(vertex.position.data()),
                                    .normal = Eigen::Vector3f(vertex.normal.data()),
                                    .tangent = Eigen::Vector4f(vertex.tangent.data())});
        for (std::size_t i = 0; i < binding.influences; ++i) {
            binding.joints.push_back(primitive->joints[number * binding.influences + i]);
            binding.weights.push_back(primitive->weights[number * binding.influences + i]);
        }
    }
}

void rest_in_pose(Model& model, const CheckedRig& checked, std::vector<MeshBinding> bindings) {
    auto rig = std::make_shared<ModelRig>(checked.rig);
    rig->bindings = std::move(bindings);
    const RigPose rest = rig_pose(*rig, nullptr, 0);
    for (ModelMesh& mesh : model.meshes) {
        if (!mesh.binding) continue;
        take_pose(mesh, *rig, rest);
        if (!mirrors(rig->bindings[*mesh.binding], *rig, rest)) continue;
        for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
            std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
    }
    model.rig = std::move(rig);
}

}  // namespace matchlight
