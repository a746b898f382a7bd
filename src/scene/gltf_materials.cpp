// Copies what is known of glTF materials, checked key by key.
#include "scene/gltf_materials.h"

#include <cmath>

#include <fmt/format.h>

namespace matchlight {
namespace {

using nlohmann::json;

class MaterialCopier {
public:
    MaterialCopier(const GltfDocument& document, Warnings& warnings) : document_(document), warnings_(warnings) {}

    json material(std::size_t number) {
        where_ = place_in("materials", number);
        const json& source = document_.item("materials", number);
        json clean = {
            {"name", source.contains("name") ? short_name(document_.text_of(source, "name", where_)) : where_}};
        json& pbr = clean["pbrMetallicRoughness"] = json::object();
        const json source_pbr = object_of(source, "pbrMetallicRoughness");
        copy_numbers(source_pbr, "baseColorFactor", 4, pbr);
        copy_number(source_pbr, "metallicFactor", pbr);
        copy_number(source_pbr, "roughnessFactor", pbr);
        copy_texture(source_pbr, "baseColorTexture", "", pbr);
        copy_texture(source_pbr, "metallicRoughnessTexture", "", pbr);
        copy_texture(source, "normalTexture", "scale", clean);
        copy_texture(source, "occlusionTexture", "strength", clean);
        copy_texture(source, "emissiveTexture", "", clean);
        copy_numbers(source, "emissiveFactor", 3, clean);
        if (clean.contains("emissiveFactor")) {
            const json extension = object_of(object_of(source, "extensions"), "KHR_materials_emissive_strength");
            const double strength = document_.number_of(extension, "emissiveStrength", 1, where_);
            for (json& factor : clean["emissiveFactor"]) factor = factor.get<double>() * strength;
        }
        if (source.contains("alphaMode")) clean["alphaMode"] = document_.text_of(source, "alphaMode", where_);
        copy_number(source, "alphaCutoff", clean);
        if (source.contains("doubleSided")) {
            if (!source["doubleSided"].is_boolean()) document_.fail(where_ + ".doubleSided is neither true nor false");
            clean["doubleSided"] = source["doubleSided"];
        }
        return clean;
    }

private:
    static std::string short_name(const std::string& name) { return name.substr(0, 100); }

    json object_of(const json& source, const char* key) const {
        const auto found = source.find(key);
        if (found == source.end()) return json::object();
        if (!found->is_object()) document_.fail(fmt::format("{}.{} is no object", where_, key));
        return *found;
    }
    void copy_number(const json& source, const char* key, json& clean) const {
        if (source.contains(key)) clean[key] = document_.number_of(source, key, 0, where_);
    }
    void copy_numbers(const json& source, const char* key, std::size_t size, json& clean) const {
        if (json numbers = document_.numbers_of(source, key, size, where_); !numbers.is_null()) {
            clean[key] = std::move(numbers);
        }
    }
    void copy_texture(const json& source, const char* key, const char* number_key, json& clean) {
        if (!source.contains(key)) return;
        const json info = object_of(source, key);
        const auto index = document_.index_of(info, "index", "textures", where_ + "." + key);
        if (!index) document_.fail(fmt::format("{}.{}.index is missing", where_, key));
        json& copy = clean[key] = {{"index", *index}};
        copy["texCoord"] = document_.unsigned_of(info, "texCoord", where_, 0);
        if (copy["texCoord"].get<std::uint64_t>() > 7)
            document_.fail(fmt::format("{}.{}.texCoord is above 7", where_, key));
        if (number_key[0] != '\0') copy_number(info, number_key, copy);
        if (object_of(info, "extensions").contains("KHR_texture_transform")) {
            warnings_.add(
                fmt::format("{}: {}.{} has a texture transform, left out", document_.path().string(), where_, key));
        }
    }

    const GltfDocument& document_;
    Warnings& warnings_;
    std::string where_;
};

TextureSource picture(const GltfDocument& document, std::size_t number) {
    const std::string where = place_in("images", number);
    const json& source = document.item("images", number);
    TextureSource texture{where, "", {}};
    if (source.contains("uri")) {
        const std::string uri = document.text_of(source, "uri", where);
        auto contents = document.resolve(uri, where);
        texture.bytes = std::move(contents.bytes);
        texture.file = std::move(contents.file);
        if (!texture.file.empty()) texture.name = texture.file.filename().string();
        return texture;
    }
    const auto view_number = document.index_of(source, "bufferView", "bufferViews", where);
    if (!view_number) return texture;  // empty: counted as missing where it is used
    // The span was checked with all buffer views.
    const json& view = document.list("bufferViews")[*view_number];
    const std::string& buffer = document.buffers()[view["buffer"].get<std::size_t>()];
    texture.bytes = buffer.substr(view.value("byteOffset", std::size_t{0}), view["byteLength"].get<std::size_t>());
    if (source.contains("name")) texture.name = document.text_of(source, "name", where).substr(0, 100);
    return texture;
}

}  // namespace

std::vector<TextureSource> add_gltf_materials(const GltfDocument& document, json& clean, Warnings& warnings) {
    MaterialCopier copier(document, warnings);
    clean["materials"] = json::array();
    for (std::size_t i = 0; i < document.list("materials").size(); ++i)
        clean["materials"].push_back(copier.material(i));

    clean["samplers"] = json::array();
    for (std::size_t i = 0; i < document.list("samplers").size(); ++i) {
        const json& source = document.item("samplers", i);
        json sampler = json::object();
        for (const char* key : {"wrapS", "wrapT"}) {
            sampler[key] = document.unsigned_of(source, key, place_in("samplers", i), 10497);  // repeat
        }
        clean["samplers"].push_back(sampler);
    }
    std::vector<TextureSource> pictures;
    clean["images"] = json::array();
    for (std::size_t i = 0; i < document.list("images").size(); ++i) {
        pictures.push_back(picture(document, i));
        clean["images"].push_back({{"uri", fmt::format("texture-{}", i)}});
    }
    clean["textures"] = json::array();
    for (std::size_t i = 0; i < document.list("textures").size(); ++i) {
        const std::string where = place_in("textures", i);
        const json& source = document.item("textures", i);
        json texture = json::object();
        if (const auto sampler = document.index_of(source, "sampler", "samplers", where)) texture["sampler"] = *sampler;
        if (const auto image = document.index_of(source, "source", "images", where)) {
            texture["source"] = *image;
        } else {
            warnings.add(
                fmt::format("{}: {} has no picture in a known format, left out", document.path().string(), where));
        }
        clean["textures"].push_back(texture);
    }
    return pictures;
}

}  // namespace matchlight
