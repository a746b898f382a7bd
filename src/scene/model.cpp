// Loads models by the kind of file they are.
#include "scene/model.h"

#include <algorithm>
#include <new>

#include <fmt/format.h>

#include "core/error.h"
#include "scene/assimp_import.h"
#include "scene/checked_model.h"
#include "scene/texture_image.h"

namespace matchlight {
namespace {

CheckedModel checked_model(const std::filesystem::path& path, Warnings& warnings) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    if (extension == ".gltf" || extension == ".glb") return check_gltf(path, warnings);
    if (extension == ".obj") return check_obj(path, warnings);
    if (extension == ".ply") return check_ply(path);
    if (extension == ".stl") return check_stl(path);
    throw InputError(path, fmt::format("models of kind '{}' are not supported", extension),
                     "use .gltf, .glb, .obj, .ply or .stl");
}

}  // namespace

bool is_color(MaterialSlot slot) {
    switch (slot) {
        case MaterialSlot::base_color:
        case MaterialSlot::emissive:
        case MaterialSlot::sheen_color:
        case MaterialSlot::specular_color:
            return true;
        default:
            return false;
    }
}

std::array<float, 2> UvMapping::operator()(const std::array<float, 2>& first,
                                           const std::array<float, 2>& second) const {
    const auto& uv = of_second ? second : first;
    return {rows[0] * uv[0] + rows[1] * uv[1] + rows[2], rows[3] * uv[0] + rows[4] * uv[1] + rows[5]};
}

std::size_t Model::triangle_count() const {
    std::size_t count = 0;
    for (const ModelMesh& mesh : meshes) count += mesh.indices.size() / 3;
    return count;
}

void Model::update_bounds() {
    bounds_m.setEmpty();
    for (const ModelMesh& mesh : meshes) {
        for (const ModelVertex& vertex : mesh.vertices) {
            const auto& p = vertex.position;
            bounds_m.extend(Eigen::Vector3d(p[0], p[1], p[2]));
        }
    }
}

Model load_model(const std::filesystem::path& path, Warnings& warnings) {
    try {
        return import_model(checked_model(path, warnings), warnings);
    } catch (const std::bad_alloc&) {
        throw InputError(path, "it does not fit into memory");
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        // The libraries that read models throw what they like.
        throw InputError(path, fmt::format("it cannot be read: {}", error.what()));
    }
}

void set_base_color_texture(Model& model, const std::filesystem::path& picture) {
    Warnings unheard;  // what a model's own texture may lack, one that the scene asks for may not
    unheard.set_quiet(true);
    auto pixels = read_texture({.name = picture.filename().string(), .bytes = {}, .file = picture}, picture, unheard);
    if (!pixels) throw InputError(picture, "it is no picture that can be read", "give a PNG or JPEG file");
    const auto index = static_cast<int>(model.textures.size());
    model.textures.push_back({.name = picture.string(), .rgba = std::move(*pixels), .sampling = {}});
    for (ModelMaterial& material : model.materials) {
        material.use(MaterialSlot::base_color) = {index, {}};
        material.base_color = {1, 1, 1, material.base_color[3]};
    }
}

void add_model_contents(ContentHash& hash, const std::filesystem::path& path, Warnings& warnings) {
    const CheckedModel model = checked_model(path, warnings);
    for (const auto& [name, contents] : model.files) {
        hash.add(name);
        hash.add(contents);
    }
    for (const TextureSource& texture : model.textures) {
        hash.add(texture.bytes);
        std::error_code missing;
        if (std::filesystem::is_regular_file(texture.file, missing)) hash.add_file(texture.file);
    }
}

}  // namespace matchlight
