// Checks a glTF file, and writes it anew with only what the loader is to see.
//
// assimp 5.2 trusts indices, follows names anywhere, and misreads some valid files: texture coordinates and positions
// that are normalised integers, vertex colours without alpha, sparse accessors over strided views, interleaved buffers
// that end with their last element. So the document handed on holds nothing but meshes, nodes and the numbers of
// materials, its buffers come from memory, and such accessors are replaced by plain ones.
#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "core/memory.h"
#include "scene/checked_model.h"
#include "scene/gltf_accessors.h"
#include "scene/gltf_lights.h"
#include "scene/gltf_materials.h"
#include "scene/gltf_rig.h"

namespace matchlight {
namespace {

using nlohmann::json;

/// No rig nests as deeply; recursive loaders do not survive much more.
constexpr std::size_t deepest_hierarchy = 256;

/// Extensions that a file may require: those of which nothing is lost.
const std::set<std::string> understood_extensions = {"KHR_mesh_quantization",    "KHR_materials_emissive_strength",
                                                     "KHR_materials_unlit",      "KHR_texture_transform",
                                                     "KHR_materials_clearcoat",  "KHR_materials_sheen",
                                                     "KHR_materials_specular",   "KHR_materials_ior",
                                                     "KHR_materials_anisotropy", "KHR_materials_transmission",
                                                     "KHR_materials_volume",     "KHR_lights_punctual"};

class GltfChecker {
public:
    GltfChecker(const std::filesystem::path& path, Warnings& warnings)
        : document_(path), accessors_(document_), warnings_(warnings), has_rig_(has_gltf_rig(document_)) {}

    CheckedModel check() {
        checked_.path = document_.path();
        checked_.entry = "model.gltf";
        check_extensions();
        add_meshes();
        add_nodes();
        clean_["asset"] = {{"version", "2.0"}};
        clean_["scene"] = 0;
        add_gltf_materials(document_, checked_, warnings_);
        // Only their numbers: what they are is read here.
        clean_["materials"] = json::array();
        for (std::size_t i = 0; i < checked_.materials.size(); ++i) {
            clean_["materials"].push_back({{"name", fmt::format("material-{}", i)}});
        }
        checked_.lamps = read_gltf_lights(document_);
        add_buffers();
        // For what depends on the model's contents.
        std::string materials;
        for (const char* list : {"materials", "textures", "samplers"}) materials += document_.list(list).dump();
        checked_.files.emplace("materials", std::move(materials));
        if (has_rig_) {
            checked_.rig = read_gltf_rig(document_, accessors_, loaded_, warnings_);
            std::string rig;
            for (const char* list : {"animations", "skins", "nodes", "meshes"}) rig += document_.list(list).dump();
            checked_.files.emplace("rig", std::move(rig));
        }
        checked_.files.emplace(checked_.entry, clean_.dump());
        return std::move(checked_);
    }

private:
    void warn(const std::string& text) { warnings_.add(fmt::format("{}: {}", document_.path().string(), text)); }
    void check_extensions();
    void add_meshes();
    std::optional<json> clean_primitive(const json& source, const std::string& where);
    std::size_t plain_floats(std::size_t accessor, int components);
    std::size_t plain_indices(std::size_t accessor, const std::vector<std::uint32_t>& values);
    std::size_t append_accessor(const void* data, std::size_t bytes, std::uint64_t count, int type,
                                const char* type_name);
    void add_nodes();
    void check_hierarchy(const std::vector<char>& has_parent) const;
    void add_buffers();

    GltfDocument document_;
    GltfAccessors accessors_;
    Warnings& warnings_;
    bool has_rig_;
    std::vector<LoadedPrimitive> loaded_;
    CheckedModel checked_;
    json clean_ = json::object();
    std::string plain_bytes_;                                   // the buffer of replaced accessors
    std::map<std::pair<std::size_t, int>, std::size_t> plain_;  // accessor and components → its replacement
    std::vector<std::optional<std::size_t>> mesh_numbers_;      // of the clean document; absent: nothing to draw
};

void GltfChecker::check_extensions() {
    for (const json& extension : document_.list("extensionsRequired")) {
        if (!extension.is_string()) document_.fail("extensionsRequired holds something that is no text");
        const auto name = extension.get<std::string>();
        if (!understood_extensions.contains(name)) {
            document_.fail(fmt::format("it requires the extension {}, which is not supported", name),
                           "export it without");
        }
    }
    for (const json& extension : document_.list("extensionsUsed")) {
        if (extension.is_string() && !understood_extensions.contains(extension.get<std::string>())) {
            warn(fmt::format("its extension {} is left out", extension.get<std::string>()));
        }
    }
}

std::size_t GltfChecker::append_accessor(const void* data, std::size_t bytes, std::uint64_t count, int type,
                                         const char* type_name) {
    // All element sizes are multiples of 4, so every view starts aligned.
    const json view = {
        {"buffer", document_.buffers().size()}, {"byteOffset", plain_bytes_.size()}, {"byteLength", bytes}};
    plain_bytes_.append(static_cast<const char*>(data), bytes);
    clean_["bufferViews"].push_back(view);
    clean_["accessors"].push_back({{"bufferView", clean_["bufferViews"].size() - 1},
                                   {"componentType", type},
                                   {"count", count},
                                   {"type", type_name}});
    return clean_["accessors"].size() - 1;
}

/// The accessor itself, or its replacement with `components` floats an element: missing ones are 1 (alpha).
std::size_t GltfChecker::plain_floats(std::size_t number, int components) {
    const GltfAccessor& accessor = accessors_.accessors()[number];
    if (accessors_.is_plain(number) && accessor.components == components) return number;
    const auto [known, is_new] = plain_.try_emplace({number, components}, 0);
    if (!is_new) return known->second;
    const std::vector<float> read = accessors_.floats(number);
    const auto width = static_cast<std::size_t>(components);
    const auto read_width = static_cast<std::size_t>(accessor.components);
    std::vector<float> values(accessor.count * width, 1.0f);
    for (std::size_t i = 0; i < accessor.count; ++i) {
        std::copy_n(read.begin() + static_cast<std::ptrdiff_t>(i * read_width), std::min(width, read_width),
                    values.begin() + static_cast<std::ptrdiff_t>(i * width));
    }
    const char* const names[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    known->second =
        append_accessor(values.data(), values.size() * sizeof(float), accessor.count, 5126, names[width - 1]);
    return known->second;
}

std::size_t GltfChecker::plain_indices(std::size_t number, const std::vector<std::uint32_t>& values) {
    if (accessors_.is_plain(number)) return number;
    const auto [known, is_new] = plain_.try_emplace({number, 0}, 0);
    if (is_new) {
        known->second =
            append_accessor(values.data(), values.size() * sizeof(std::uint32_t), values.size(), 5125, "SCALAR");
    }
    return known->second;
}

/// A primitive with nothing but triangles and the attributes that are drawn; nullopt for points and lines.
std::optional<json> GltfChecker::clean_primitive(const json& source, const std::string& where) {
    if (!source.is_object() || !source.contains("attributes") || !source["attributes"].is_object()) {
        document_.fail(where + " has no attributes");
    }
    const std::uint64_t mode = document_.unsigned_of(source, "mode", where, 4);
    if (mode > 6) document_.fail(where + ".mode is above 6");
    const json& attributes = source["attributes"];
    const auto position = document_.index_of(attributes, "POSITION", "accessors", where);
    if (!position) {
        warn(where + " has no positions, left out");
        return std::nullopt;
    }
    const std::uint64_t vertex_count = accessors_.accessors()[*position].count;

    json clean = {{"mode", mode}, {"attributes", json::object()}};
    for (const auto& [name, value] : attributes.items()) {
        int components = 0;
        if (name == "POSITION" || name == "NORMAL") components = 3;
        if (name == "TANGENT" || name == "COLOR_0") components = 4;
        if (name.size() == 10 && name.starts_with("TEXCOORD_") && name[9] < '8') components = 2;  // assimp holds eight
        const std::size_t accessor = *document_.index_of(attributes, name.c_str(), "accessors", where);
        if (components == 0) continue;  // joints, weights, further colours, an application's own
        const int given = accessors_.accessors()[accessor].components;
        const bool color_without_alpha = name == "COLOR_0" && given == 3;
        if (given != components && !color_without_alpha) {
            document_.fail(fmt::format("{}.{} has {} components", where, name, given));
        }
        if (accessors_.accessors()[accessor].count != vertex_count) {
            document_.fail(fmt::format("{}.{} has {} elements for {} vertices", where, name,
                                       accessors_.accessors()[accessor].count, vertex_count));
        }
        clean["attributes"][name] = plain_floats(accessor, components);
    }
    std::uint64_t corner_count = vertex_count;
    if (const auto indices = document_.index_of(source, "indices", "accessors", where)) {
        const std::vector<std::uint32_t> values = accessors_.indices(*indices);
        const std::uint32_t largest = *std::max_element(values.begin(), values.end());
        if (largest >= vertex_count) {
            document_.fail(fmt::format("{}: index {} is beyond its {} vertices", where, largest, vertex_count));
        }
        corner_count = values.size();
        clean["indices"] = plain_indices(*indices, values);
    }
    if (mode < 4 || corner_count < 3) {
        warn(where + " holds no triangles, left out");
        return std::nullopt;
    }
    if (const auto material = document_.index_of(source, "material", "materials", where)) clean["material"] = *material;
    return clean;
}

void GltfChecker::add_meshes() {
    // The views and accessors of the file keep their numbers; replacements follow them.
    clean_["bufferViews"] = json::array();
    for (const GltfBufferView& view : accessors_.views()) {
        json clean = {{"buffer", view.buffer}, {"byteOffset", view.offset}, {"byteLength", view.length}};
        if (view.stride > 0) clean["byteStride"] = view.stride;
        clean_["bufferViews"].push_back(clean);
    }
    clean_["accessors"] = json::array();
    const char* const names[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    for (const GltfAccessor& accessor : accessors_.accessors()) {
        json clean = {
            {"componentType", accessor.component_type}, {"count", accessor.count}, {"byteOffset", accessor.offset}};
        clean["type"] = accessor.components <= 4 ? names[accessor.components] : "SCALAR";
        if (accessor.view) clean["bufferView"] = *accessor.view;
        clean_["accessors"].push_back(clean);
    }
    clean_["meshes"] = json::array();
    for (std::size_t i = 0; i < document_.list("meshes").size(); ++i) {
        const json& mesh = document_.item("meshes", i);
        const auto primitives = mesh.find("primitives");
        if (primitives == mesh.end() || !primitives->is_array()) {
            document_.fail(place_in("meshes", i) + " has no primitives");
        }
        json clean = json::array();
        for (std::size_t p = 0; p < primitives->size(); ++p) {
            const std::string where = fmt::format("meshes[{}].primitives[{}]", i, p);
            auto primitive = clean_primitive((*primitives)[p], where);
            if (!primitive) continue;
            if (has_rig_) loaded_.push_back({.mesh = i, .primitive = p, .name = fmt::format("-{}", clean.size())});
            clean.push_back(std::move(*primitive));
        }
        mesh_numbers_.emplace_back();
        if (clean.empty()) continue;
        mesh_numbers_.back() = clean_["meshes"].size();
        // assimp numbers the primitives of a mesh that has more than one.
        const std::string name = fmt::format("mesh-{}", clean_["meshes"].size());
        for (LoadedPrimitive& loaded : loaded_) {
            if (loaded.mesh == i) loaded.name = clean.size() > 1 ? name + loaded.name : name;
        }
        clean_["meshes"].push_back({{"primitives", std::move(clean)}});
        if (has_rig_) clean_["meshes"].back()["name"] = name;
    }
}

void GltfChecker::add_nodes() {
    const json& nodes = document_.list("nodes");
    std::vector<char> has_parent(nodes.size(), 0);
    clean_["nodes"] = json::array();
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const std::string where = place_in("nodes", i);
        const json& node = document_.item("nodes", i);
        json clean = json::object();
        const std::pair<const char*, std::size_t> transforms[] = {
            {"matrix", 16}, {"translation", 3}, {"rotation", 4}, {"scale", 3}};
        for (const auto& [key, size] : transforms) {
            if (json numbers = document_.numbers_of(node, key, size, where); !numbers.is_null()) {
                clean[key] = std::move(numbers);
            }
        }
        if (const auto mesh = document_.index_of(node, "mesh", "meshes", where); mesh && mesh_numbers_[*mesh]) {
            clean["mesh"] = *mesh_numbers_[*mesh];
        }
        if (has_rig_) clean["name"] = fmt::format("node-{}", i);
        if (node.contains("children")) {
            if (!node["children"].is_array()) document_.fail(where + ".children is no array");
            for (const json& child : node["children"]) {
                const std::size_t number = *document_.index_of({{"child", child}}, "child", "nodes", where);
                if (has_parent[number]) document_.fail(fmt::format("nodes[{}] has two parents", number));
                has_parent[number] = 1;
                clean["children"].push_back(number);
            }
        }
        clean_["nodes"].push_back(std::move(clean));
    }

    std::vector<std::size_t> roots;
    if (const auto scene = document_.index_of(document_.root(), "scene", "scenes", "scene");
        scene || !document_.list("scenes").empty()) {
        const std::string where = place_in("scenes", scene.value_or(0));
        const json& source = document_.item("scenes", scene.value_or(0));
        const json listed = source.value("nodes", json::array());
        if (!listed.is_array()) document_.fail(where + ".nodes is no array");
        std::set<std::size_t> seen;
        for (const json& root : listed) {
            roots.push_back(*document_.index_of({{"node", root}}, "node", "nodes", where));
            if (has_parent[roots.back()]) document_.fail(fmt::format("{}: nodes[{}] is no root", where, roots.back()));
            if (!seen.insert(roots.back()).second) document_.fail(where + " lists a node twice");
        }
    } else {
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            if (!has_parent[i]) roots.push_back(i);
        }
    }
    check_hierarchy(has_parent);
    clean_["scenes"] = json::array({{{"nodes", roots}}});
}

/// Every node has one parent at most, so what is not below a node without one lies on a cycle.
void GltfChecker::check_hierarchy(const std::vector<char>& has_parent) const {
    const json& nodes = clean_["nodes"];
    std::vector<std::pair<std::size_t, std::size_t>> open;  // node, depth
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (!has_parent[i]) open.emplace_back(i, 1);
    }
    std::size_t visited = 0;
    while (!open.empty()) {
        const auto [node, depth] = open.back();
        open.pop_back();
        ++visited;
        if (depth > deepest_hierarchy) document_.fail(fmt::format("its nodes nest deeper than {}", deepest_hierarchy));
        for (const json& child : nodes[node].value("children", json::array())) {
            open.emplace_back(child.get<std::size_t>(), depth + 1);
        }
    }
    if (visited < nodes.size()) document_.fail("its nodes form a cycle");
}

void GltfChecker::add_buffers() {
    clean_["buffers"] = json::array();
    const auto add = [&](std::string bytes) {
        const std::string name = fmt::format("{}.bin", clean_["buffers"].size());
        // A buffer of no bytes needs no file.
        if (bytes.empty()) bytes.assign(4, '\0');
        clean_["buffers"].push_back({{"byteLength", bytes.size()}, {"uri", name}});
        checked_.files.emplace(name, std::move(bytes));
    };
    for (const std::string& buffer : document_.buffers()) add(buffer);
    add(std::move(plain_bytes_));
}

}  // namespace

CheckedModel check_gltf(const std::filesystem::path& path, Warnings& warnings) {
    return GltfChecker(path, warnings).check();
}

}  // namespace matchlight
