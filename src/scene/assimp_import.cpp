// Runs assimp on checked files and flattens its scene.
#include "scene/assimp_import.h"

#include <cmath>
#include <memory>

#include <assimp/BaseImporter.h>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "core/error.h"
#include "core/memory.h"
#include "core/transfer.h"
#include "core/transforms.h"
#include "scene/mesh_geometry.h"
#include "scene/rig_binding.h"

namespace matchlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

/// Creases where faces without normals turn by more than this; glTF asks for flat ones there, but scanned and converted
/// meshes without normals are smooth far more often than faceted.
constexpr double crease_deg = 45;

/// Gives assimp the checked files and nothing from the disk.
class CheckedFiles : public Assimp::IOSystem {
public:
    explicit CheckedFiles(const std::map<std::string, std::string>& files) : files_(files) {}
    bool Exists(const char* name) const override { return find(name) != nullptr; }
    char getOsSeparator() const override { return '/'; }
    Assimp::IOStream* Open(const char* name, const char* mode) override {
        const std::string* bytes = find(name);
        if (bytes == nullptr || mode == nullptr || mode[0] != 'r') return nullptr;
        return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size());
    }
    void Close(Assimp::IOStream* stream) override { delete stream; }

private:
    const std::string* find(std::string_view name) const {
        while (name.starts_with("./")) name.remove_prefix(2);
        const auto found = files_.find(std::string(name));
        return found == files_.end() ? nullptr : &found->second;
    }
    const std::map<std::string, std::string>& files_;
};

/// Leaves only the loader that the checks were made for: assimp tries the others on files it does not recognise.
void keep_one_loader(Assimp::Importer& importer, const std::string& entry) {
    const std::map<std::string, std::string> loaders = {{".gltf", "glTF2 Importer"},
                                                        {".obj", "Wavefront Object Importer"},
                                                        {".ply", "Stanford Polygon Library (PLY) Importer"},
                                                        {".stl", "Stereolithography (STL) Importer"}};
    const std::string& wanted = loaders.at(entry.substr(entry.rfind('.')));
    for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
        if (importer.GetImporterInfo(i)->mName == wanted) continue;
        const std::unique_ptr<Assimp::BaseImporter> other(importer.GetImporter(i));
        importer.UnregisterLoader(other.get());  // and leaves it to the caller
    }
}

/// Texture coordinates after a transform of the file.
std::array<float, 2> moved(const std::array<float, 2>& uv, const std::array<double, 6>& rows) {
    const auto row = [&](std::size_t i) {
        return static_cast<float>(rows[i] * static_cast<double>(uv[0]) + rows[i + 1] * static_cast<double>(uv[1]) +
                                  rows[i + 2]);
    };
    return {row(0), row(3)};
}

class SceneFlattener {
public:
    SceneFlattener(const aiScene& scene, const CheckedModel& checked, Warnings& warnings)
        : scene_(scene), checked_(checked), warnings_(warnings), textures_(checked, model_, warnings) {}

    Model flatten() {
        model_.name = checked_.path.stem().string();
        Matrix4d world_from_file = Matrix4d::Identity();
        world_from_file.topLeftCorner<3, 3>() = world_from_model_axes();
        check_memory();
        add_node(*scene_.mRootNode, world_from_file);
        report();
        if (!bindings_.empty()) rest_in_pose(model_, *checked_.rig, std::move(bindings_));
        model_.lamps = checked_.lamps;
        model_.update_bounds();
        return std::move(model_);
    }

private:
    void check_memory() const;
    static std::uint64_t corner_count(const aiScene& scene, const aiNode& node);
    void add_node(const aiNode& node, const Matrix4d& world_from_parent);
    void add_mesh(const aiMesh& mesh, const aiNode& node, const Matrix4d& world_from_mesh);
    const CheckedPrimitive* primitive_of(const aiMesh& mesh) const;
    /// How the vertices of a material are kept.
    struct KeptMaterial {
        int number = 0;  // in the model
        ImportedMaterial layout;
    };
    void add_vertices(const aiMesh& mesh, const Matrix4d& world_from_mesh, const ImportedMaterial& layout,
                      ModelMesh& to);
    const KeptMaterial& material_of(const aiMesh& mesh, double scale);
    void report();

    const aiScene& scene_;
    const CheckedModel& checked_;
    Warnings& warnings_;
    Model model_;
    TextureTable textures_;
    /// By assimp's index, and by the scale of its mesh where it has a thickness in the mesh's units.
    std::map<std::pair<unsigned, double>, KeptMaterial> materials_;
    std::vector<MeshBinding> bindings_;
    std::size_t dropped_triangles_ = 0;
    std::size_t repaired_normals_ = 0;
    std::size_t repaired_attributes_ = 0;
    std::size_t repaired_tangents_ = 0;
    std::size_t points_and_lines_ = 0;
};

std::uint64_t SceneFlattener::corner_count(const aiScene& scene, const aiNode& node) {
    std::uint64_t count = 0;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) count += 3ull * scene.mMeshes[node.mMeshes[i]]->mNumFaces;
    for (unsigned i = 0; i < node.mNumChildren; ++i) count += corner_count(scene, *node.mChildren[i]);
    return count;
}

/// A mesh that many nodes show is there many times once it is flattened.
void SceneFlattener::check_memory() const {
    // Up to three copies of a vertex while normals are made.
    const std::uint64_t needed = corner_count(scene_, *scene_.mRootNode) * (3 * sizeof(ModelVertex) + 64);
    if (needed > available_memory_bytes()) {
        throw InputError(checked_.path, fmt::format("it needs {} MB of memory, more than there is", needed >> 20));
    }
}

void SceneFlattener::add_node(const aiNode& node, const Matrix4d& world_from_parent) {
    Matrix4d parent_from_node;
    for (unsigned row = 0; row < 4; ++row) {
        for (unsigned column = 0; column < 4; ++column) {
            parent_from_node(row, column) = static_cast<double>(node.mTransformation[row][column]);
        }
    }
    const Matrix4d world_from_node = world_from_parent * parent_from_node;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) add_mesh(*scene_.mMeshes[node.mMeshes[i]], node, world_from_node);
    for (unsigned i = 0; i < node.mNumChildren; ++i) add_node(*node.mChildren[i], world_from_node);
}

const SceneFlattener::KeptMaterial& SceneFlattener::material_of(const aiMesh& mesh, double scale) {
    for (const double of_scale : {1.0, scale}) {
        const auto found = materials_.find({mesh.mMaterialIndex, of_scale});
        if (found == materials_.end()) continue;
        const auto& transmission = found->second.layout.material.transmission;
        if (of_scale == scale || !transmission || transmission->thickness == 0) return found->second;
    }
    ImportedMaterial layout;
    if (mesh.mMaterialIndex < scene_.mNumMaterials && scene_.mMaterials[mesh.mMaterialIndex] != nullptr) {
        layout = translated_material(*scene_.mMaterials[mesh.mMaterialIndex], checked_, textures_, warnings_);
    }
    // Scanned colours already hold what a default grey stands for.
    if (mesh.HasVertexColors(0) && !checked_.entry.ends_with(".gltf")) layout.material.base_color = {1, 1, 1, 1};
    auto& transmission = layout.material.transmission;
    const bool is_thick = transmission && transmission->thickness > 0;
    if (is_thick) transmission->thickness *= static_cast<float>(scale);
    model_.materials.push_back(layout.material);
    const KeptMaterial kept{static_cast<int>(model_.materials.size()) - 1, std::move(layout)};
    return materials_.emplace(std::pair(mesh.mMaterialIndex, is_thick ? scale : 1.0), kept).first->second;
}

void SceneFlattener::add_vertices(const aiMesh& from, const Matrix4d& world_from_mesh, const ImportedMaterial& layout,
                                  ModelMesh& to) {
    const Matrix3d linear = world_from_mesh.topLeftCorner<3, 3>();
    const double side = linear.determinant() < 0 ? -1 : 1;
    // The cofactors turn normals as the inverse transpose does, and exist where a scale is zero.
    Matrix3d normal_matrix;
    normal_matrix << linear.col(1).cross(linear.col(2)), linear.col(2).cross(linear.col(0)),
        linear.col(0).cross(linear.col(1));
    normal_matrix *= side;
    const auto vector_of = [](const aiVector3D& v) { return Vector3d(v.x, v.y, v.z); };
    const auto narrowed = [](const Vector3d& v) {
        return std::array{static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
    };
    // glTF's vertex colours are linear; scanners and modellers write the others as they show them, sRGB-coded.
    const bool linear_colors = checked_.entry.ends_with(".gltf");
    const auto color_of = [&](float value) {
        return linear_colors ? value : static_cast<float>(linear_from_srgb_code(static_cast<double>(value)));
    };

    const auto uv_of = [&](unsigned set, unsigned vertex) {
        if (!from.HasTextureCoords(set)) return std::array{0.0F, 0.0F};
        const aiVector3D& uv = from.mTextureCoords[set][vertex];
        return std::array{uv.x, 1 - uv.y};  // assimp's v grows upwards in every format
    };

    to.vertices.resize(from.mNumVertices);
    for (unsigned i = 0; i < from.mNumVertices; ++i) {
        ModelVertex& vertex = to.vertices[i];
        vertex.position = narrowed(linear * vector_of(from.mVertices[i]) + world_from_mesh.topRightCorner<3, 1>());
        vertex.normal = {0, 0, 0};
        if (from.HasNormals()) {
            vertex.normal = narrowed((normal_matrix * vector_of(from.mNormals[i])).normalized());
        }
        vertex.tangent = {0, 0, 0, 0};
        if (from.HasTangentsAndBitangents() && from.HasNormals()) {
            const auto tangent = narrowed((linear * vector_of(from.mTangents[i])).normalized());
            const double hand =
                vector_of(from.mNormals[i]).cross(vector_of(from.mTangents[i])).dot(vector_of(from.mBitangents[i]));
            vertex.tangent = {tangent[0], tangent[1], tangent[2], static_cast<float>(hand < 0 ? -side : side)};
        }
        vertex.uv = moved(uv_of(layout.first_set, i), layout.first_rows);
        vertex.uv_second = layout.second_set ? uv_of(*layout.second_set, i) : std::array{0.0F, 0.0F};
        vertex.color = {1, 1, 1, 1};
        if (from.HasVertexColors(0)) {
            const aiColor4D& color = from.mColors[0][i];
            vertex.color = {color_of(color.r), color_of(color.g), color_of(color.b), color.a};
        }
        bool repaired = false;
        for (auto* pair : {&vertex.uv, &vertex.uv_second}) {
            for (float& value : *pair) {
                if (!std::isfinite(value)) repaired = true, value = 0;
            }
        }
        for (float& value : vertex.color) {
            if (!std::isfinite(value)) repaired = true, value = 1;
        }
        for (const float value : vertex.tangent) {
            if (!std::isfinite(value)) {
                repaired = true;
                vertex.tangent = {0, 0, 0, 0};
                break;
            }
        }
        if (repaired) ++repaired_attributes_;
    }
}

/// Null where its vertices do not move against each other.
const CheckedPrimitive* SceneFlattener::primitive_of(const aiMesh& mesh) const {
    const auto found = checked_.rig->primitives.find(mesh.mName.C_Str());
    if (found == checked_.rig->primitives.end()) return nullptr;
    if (found->second.vertex_count != mesh.mNumVertices) {
        throw InputError(checked_.path, fmt::format("{} vertices were read of {} that move", mesh.mNumVertices,
                                                    found->second.vertex_count));
    }
    return &found->second;
}

void SceneFlattener::add_mesh(const aiMesh& from, const aiNode& node, const Matrix4d& world_from_node) {
    ModelMesh to;
    const KeptMaterial& kept =
        material_of(from, std::cbrt(std::abs(world_from_node.topLeftCorner<3, 3>().determinant())));
    to.material = kept.number;
    // What moves stays in its own axes until it is posed.
    std::optional<MeshBinding> binding;
    if (checked_.rig) binding = binding_of(*checked_.rig, node.mName.C_Str(), from.mName.C_Str());
    const Matrix4d world_from_mesh = binding ? Matrix4d::Identity() : world_from_node;
    add_vertices(from, world_from_mesh, kept.layout, to);
    std::vector<std::array<float, 4>> colors;
    if (binding) colors = number_vertices(to);

    const bool mirrored = world_from_mesh.topLeftCorner<3, 3>().determinant() < 0;
    to.indices.reserve(3ull * from.mNumFaces);
    for (unsigned f = 0; f < from.mNumFaces; ++f) {
        const aiFace& face = from.mFaces[f];
        if (face.mNumIndices != 3) {
            ++points_and_lines_;
            continue;
        }
        for (const unsigned corner : {0u, mirrored ? 2u : 1u, mirrored ? 1u : 2u}) {
            const unsigned index = face.mIndices[corner];
            if (index >= from.mNumVertices) {
                throw InputError(checked_.path, fmt::format("vertex {} of a face is beyond the {} vertices", index,
                                                            from.mNumVertices));
            }
            to.indices.push_back(index);
        }
    }
    dropped_triangles_ += drop_bad_triangles(to);
    if (to.indices.empty()) return;

    // STL's normals are those of its facets: they say nothing of the surface that was meant.
    if (from.HasNormals() && !checked_.entry.ends_with(".stl")) {
        weld(to);
        repaired_normals_ += repair_normals(to);
    } else {
        compute_normals(to, crease_deg);
    }
    const ModelMaterial& material = kept.layout.material;
    const auto has = [&](MaterialSlot slot) { return material.texture(slot) >= 0; };
    const bool needs_tangents = has(MaterialSlot::normal) || has(MaterialSlot::coat_normal) || material.anisotropy;
    MaterialSlot leading = MaterialSlot::anisotropy;
    if (has(MaterialSlot::coat_normal)) leading = MaterialSlot::coat_normal;
    if (has(MaterialSlot::normal)) leading = MaterialSlot::normal;
    if (!needs_tangents) {
        for (ModelVertex& vertex : to.vertices) vertex.tangent = {0, 0, 0, 0};
    } else if (!from.HasTangentsAndBitangents() || !from.HasNormals()) {
        compute_tangents(to, material.use(leading).mapping);
    } else {
        repaired_tangents_ += repair_tangents(to, material.use(leading).mapping);
    }
    if (binding) {
        bind_vertices(to, colors, primitive_of(from), *binding);
        to.binding = bindings_.size();
        bindings_.push_back(std::move(*binding));
    }
    model_.meshes.push_back(std::move(to));
}

void SceneFlattener::report() {
    const auto count = [&](std::size_t number, const char* what) {
        if (number > 0) warnings_.add(fmt::format("{}: {} {}", checked_.path.string(), number, what));
    };
    count(dropped_triangles_, "triangles without area or with positions that are not finite, dropped");
    count(repaired_normals_, "normals that are zero or not finite, computed");
    count(repaired_attributes_, "vertices with texture coordinates, colours or tangents that are not finite, replaced");
    count(repaired_tangents_, "tangents that are zero or lie along the normal, replaced");
    count(points_and_lines_, "points and lines, left out");
    if (model_.meshes.empty()) throw InputError(checked_.path, "it has no triangles");
}

}  // namespace

Model import_model(const CheckedModel& checked, Warnings& warnings) {
    Assimp::Importer importer;
    importer.SetIOHandler(new CheckedFiles(checked.files));  // the importer deletes it
    keep_one_loader(importer, checked.entry);
    // The validation runs before everything that follows indices.
    const unsigned steps = aiProcess_ValidateDataStructure | aiProcess_Triangulate;
    const aiScene* scene = importer.ReadFile(checked.entry, steps);
    if (scene == nullptr || scene->mRootNode == nullptr) {
        throw InputError(checked.path, fmt::format("it cannot be read: {}", importer.GetErrorString()));
    }
    return SceneFlattener(*scene, checked, warnings).flatten();
}

}  // namespace matchlight
