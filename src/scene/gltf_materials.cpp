// Reads what is known of glTF materials, checked key by key.
#include "scene/gltf_materials.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

namespace matchlight {
namespace {

using nlohmann::json;

/// A texture of the file: its picture, and how that is read.
struct FileTexture {
    int picture = -1;
    TextureSampling sampling;
};

float unit(double value) {
    return static_cast<float>(std::clamp(value, 0.0, 1.0));
}

/// "extensions": {"KHR_materials_coat": {…}} and their like, key by key.
class MaterialReader {
public:
    MaterialReader(const GltfDocument& document, const std::vector<FileTexture>& textures, Warnings& warnings)
        : document_(document), textures_(textures), warnings_(warnings) {}

    CheckedMaterial read(std::size_t number) {
        where_ = place_in("materials", number);
        read_ = {};
        const json& source = document_.item("materials", number);
        read_.material.name =
            source.contains("name") ? document_.text_of(source, "name", where_).substr(0, 100) : where_;
        read_base(source);
        const json extensions = object_of(source, "extensions");
        read_.material.unlit = extensions.contains("KHR_materials_unlit");
        if (extensions.contains("KHR_materials_clearcoat")) read_coat(object_of(extensions, "KHR_materials_clearcoat"));
        if (extensions.contains("KHR_materials_sheen")) read_sheen(object_of(extensions, "KHR_materials_sheen"));
        if (extensions.contains("KHR_materials_specular"))
            read_specular(object_of(extensions, "KHR_materials_specular"));
        if (extensions.contains("KHR_materials_anisotropy"))
            read_anisotropy(object_of(extensions, "KHR_materials_anisotropy"));
        if (extensions.contains("KHR_materials_transmission"))
            read_transmission(object_of(extensions, "KHR_materials_transmission"),
                              object_of(extensions, "KHR_materials_volume"));
        read_ior(object_of(extensions, "KHR_materials_ior"));
        return std::move(read_);
    }

private:
    void read_base(const json& source) {
        ModelMaterial& to = read_.material;
        const json pbr = object_of(source, "pbrMetallicRoughness");
        if (const auto base = numbers(pbr, "baseColorFactor", 4)) std::copy_n(base->begin(), 4, to.base_color.begin());
        to.metallic = unit(number(pbr, "metallicFactor", 1));
        to.roughness = unit(number(pbr, "roughnessFactor", 1));
        if (const auto light = numbers(source, "emissiveFactor", 3)) {
            const json extension = object_of(object_of(source, "extensions"), "KHR_materials_emissive_strength");
            const double strength = number(extension, "emissiveStrength", 1);
            for (std::size_t c = 0; c < 3; ++c) to.emissive[c] = static_cast<float>((*light)[c] * strength);
        }
        read_texture(pbr, "baseColorTexture", MaterialSlot::base_color);
        read_texture(pbr, "metallicRoughnessTexture", MaterialSlot::metallic_roughness);
        to.normal_scale =
            static_cast<float>(number(read_texture(source, "normalTexture", MaterialSlot::normal), "scale", 1));
        to.occlusion_strength =
            unit(number(read_texture(source, "occlusionTexture", MaterialSlot::occlusion), "strength", 1));
        read_texture(source, "emissiveTexture", MaterialSlot::emissive);
        if (source.contains("alphaMode")) {
            const std::string mode = document_.text_of(source, "alphaMode", where_);
            if (mode == "MASK") to.alpha_mode = AlphaMode::mask;
            if (mode == "BLEND") to.alpha_mode = AlphaMode::blend;
        }
        to.alpha_cutoff = static_cast<float>(number(source, "alphaCutoff", 0.5));
        if (source.contains("doubleSided")) {
            if (!source["doubleSided"].is_boolean()) document_.fail(where_ + ".doubleSided is neither true nor false");
            to.double_sided = source["doubleSided"].get<bool>();
        }
    }

    void read_coat(const json& source) {
        CoatFactors& coat = read_.material.coat.emplace();
        coat.strength = unit(number(source, "clearcoatFactor", 0));
        coat.roughness = unit(number(source, "clearcoatRoughnessFactor", 0));
        read_texture(source, "clearcoatTexture", MaterialSlot::coat);
        read_texture(source, "clearcoatRoughnessTexture", MaterialSlot::coat_roughness);
        const json normal = read_texture(source, "clearcoatNormalTexture", MaterialSlot::coat_normal);
        coat.normal_scale = static_cast<float>(number(normal, "scale", 1));
    }
    void read_sheen(const json& source) {
        SheenFactors& sheen = read_.material.sheen.emplace();
        sheen.color = color(source, "sheenColorFactor", 0);
        for (float& channel : sheen.color) channel = std::min(channel, 1.0F);
        sheen.roughness = unit(number(source, "sheenRoughnessFactor", 0));
        read_texture(source, "sheenColorTexture", MaterialSlot::sheen_color);
        read_texture(source, "sheenRoughnessTexture", MaterialSlot::sheen_roughness);
    }
    void read_specular(const json& source) {
        SpecularFactors& specular = read_.material.specular.emplace();
        specular.strength = unit(number(source, "specularFactor", 1));
        specular.color = color(source, "specularColorFactor", 1);
        read_texture(source, "specularTexture", MaterialSlot::specular);
        read_texture(source, "specularColorTexture", MaterialSlot::specular_color);
    }
    void read_anisotropy(const json& source) {
        AnisotropyFactors& anisotropy = read_.material.anisotropy.emplace();
        anisotropy.strength = unit(number(source, "anisotropyStrength", 0));
        anisotropy.rotation_rad = static_cast<float>(number(source, "anisotropyRotation", 0));
        read_texture(source, "anisotropyTexture", MaterialSlot::anisotropy);
    }
    void read_transmission(const json& source, const json& volume) {
        TransmissionFactors& transmission = read_.material.transmission.emplace();
        transmission.strength = unit(number(source, "transmissionFactor", 0));
        read_texture(source, "transmissionTexture", MaterialSlot::transmission);
        transmission.thickness = static_cast<float>(std::max(number(volume, "thicknessFactor", 0), 0.0));
        read_texture(volume, "thicknessTexture", MaterialSlot::thickness);
        const double distance = number(volume, "attenuationDistance", std::numeric_limits<double>::infinity());
        if (!(distance > 0)) document_.fail(where_ + ".attenuationDistance is not above 0");
        transmission.attenuation_distance = static_cast<float>(distance);
        transmission.attenuation_color = color(volume, "attenuationColor", 1);
        for (float& channel : transmission.attenuation_color) channel = std::min(channel, 1.0F);
    }
    void read_ior(const json& source) {
        const double ior = number(source, "ior", 1.5);
        if (ior != 0 && ior < 1) document_.fail(where_ + ".ior is below 1");
        read_.material.ior = static_cast<float>(ior);
    }
    Rgb color(const json& source, const char* key, float fallback) const {
        const auto given = numbers(source, key, 3);
        Rgb color{fallback, fallback, fallback};
        for (std::size_t c = 0; given && c < 3; ++c) color[c] = static_cast<float>(std::max((*given)[c], 0.0));
        return color;
    }

    json object_of(const json& source, const char* key) const {
        const auto found = source.find(key);
        if (found == source.end()) return json::object();
        if (!found->is_object()) document_.fail(fmt::format("{}.{} is no object", where_, key));
        return *found;
    }
    double number(const json& source, const char* key, double fallback) const {
        return document_.number_of(source, key, fallback, where_);
    }
    std::optional<std::vector<double>> numbers(const json& source, const char* key, std::size_t size) const {
        const json found = document_.numbers_of(source, key, size, where_);
        if (found.is_null()) return std::nullopt;
        return found.get<std::vector<double>>();
    }

    /// The texture's own object, which may say more of it; an empty one where there is none.
    json read_texture(const json& source, const char* key, MaterialSlot slot) {
        if (!source.contains(key)) return json::object();
        const json info = object_of(source, key);
        const std::string place = where_ + "." + key;
        const auto index = document_.index_of(info, "index", "textures", place);
        if (!index) document_.fail(place + ".index is missing");
        CheckedMaterial::Placement& placement = read_.placements.at(static_cast<std::size_t>(slot));
        const FileTexture& texture = textures_.at(*index);
        read_.material.texture(slot) = texture.picture;
        placement.sampling = texture.sampling;
        const json transform = object_of(object_of(info, "extensions"), "KHR_texture_transform");
        const std::uint64_t set = document_.unsigned_of(info, "texCoord", where_, 0);
        placement.set = static_cast<unsigned>(
            std::min<std::uint64_t>(document_.unsigned_of(transform, "texCoord", place, set), most_sets));
        if (placement.set >= most_sets) document_.fail(place + ".texCoord is above 7");
        read_transform(transform, place, placement.rows);
        return info;
    }

    /// Scaled, then turned against the clock as the picture is seen, then moved.
    void read_transform(const json& source, const std::string& place, std::array<double, 6>& rows) const {
        const auto scale = numbers(source, "scale", 2).value_or(std::vector{1.0, 1.0});
        const auto offset = numbers(source, "offset", 2).value_or(std::vector{0.0, 0.0});
        const double turn = number(source, "rotation", 0);
        if (scale[0] == 0 || scale[1] == 0) {
            warnings_.add(fmt::format("{}: the transform of {} leaves the texture no extent, left out",
                                      document_.path().string(), place));
            return;
        }
        const double c = std::cos(turn), s = std::sin(turn);
        rows = {c * scale[0], s * scale[1], offset[0], -s * scale[0], c * scale[1], offset[1]};
    }

    static constexpr std::uint64_t most_sets = 8;  // that assimp holds

    const GltfDocument& document_;
    const std::vector<FileTexture>& textures_;
    Warnings& warnings_;
    std::string where_;
    CheckedMaterial read_;
};

TextureWrap wrap_of(std::uint64_t mode) {
    if (mode == 33071) return TextureWrap::clamp;
    return mode == 33648 ? TextureWrap::mirror : TextureWrap::repeat;
}

/// OpenGL's numbers; what is not said, or unknown, is read as smoothly as it can be.
TextureSampling sampling(const GltfDocument& document, std::size_t number) {
    const std::string where = place_in("samplers", number);
    const json& source = document.item("samplers", number);
    constexpr std::uint64_t repeat = 10497, nearest = 9728, linear = 9729, trilinear = 9987;
    TextureSampling read;
    read.wrap_u = wrap_of(document.unsigned_of(source, "wrapS", where, repeat));
    read.wrap_v = wrap_of(document.unsigned_of(source, "wrapT", where, repeat));
    read.is_smooth_near = document.unsigned_of(source, "magFilter", where, linear) != nearest;
    const std::uint64_t far = document.unsigned_of(source, "minFilter", where, trilinear);
    read.is_smooth_far = far != nearest && far != 9984 && far != 9986;
    if (far == nearest || far == linear) read.mipmaps = TextureMipmaps::none;
    if (far == 9984 || far == 9985) read.mipmaps = TextureMipmaps::nearest;
    return read;
}

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

void add_gltf_materials(const GltfDocument& document, CheckedModel& checked, Warnings& warnings) {
    for (std::size_t i = 0; i < document.list("images").size(); ++i) checked.textures.push_back(picture(document, i));
    std::vector<FileTexture> textures;
    for (std::size_t i = 0; i < document.list("textures").size(); ++i) {
        const std::string where = place_in("textures", i);
        const json& source = document.item("textures", i);
        FileTexture& texture = textures.emplace_back();
        if (const auto sampler = document.index_of(source, "sampler", "samplers", where)) {
            texture.sampling = sampling(document, *sampler);
        }
        if (const auto image = document.index_of(source, "source", "images", where)) {
            texture.picture = static_cast<int>(*image);
        } else {
            warnings.add(
                fmt::format("{}: {} has no picture in a known format, left out", document.path().string(), where));
        }
    }
    MaterialReader reader(document, textures, warnings);
    for (std::size_t i = 0; i < document.list("materials").size(); ++i) checked.materials.push_back(reader.read(i));
}

}  // namespace matchlight
