// Writes small glTF files, good and bad.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace matchlight {

/// A document with one binary buffer. Start with `triangle()` and change what the test is about.
struct GltfBuilder {
    nlohmann::json root;
    std::string binary;

    GltfBuilder() {
        root = {{"asset", {{"version", "2.0"}}},         {"scene", 0},
                {"scenes", {{{"nodes", {0}}}}},          {"nodes", {{{"mesh", 0}}}},
                {"meshes", nlohmann::json::array()},     {"accessors", nlohmann::json::array()},
                {"bufferViews", nlohmann::json::array()}};
    }

    /// One triangle in the plane z = 0 of glTF's axes, (0,0,0) (1,0,0) (0,1,0), with normals +z and indices.
    static GltfBuilder triangle() {
        GltfBuilder builder;
        const std::size_t positions = builder.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 5126, "VEC3");
        const std::size_t normals = builder.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, 5126, "VEC3");
        const std::size_t indices = builder.add<std::uint16_t>({0, 1, 2}, 5123, "SCALAR");
        builder.root["meshes"].push_back(
            {{"primitives", {{{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"indices", indices}}}}});
        return builder;
    }

    nlohmann::json& primitive() { return root["meshes"][0]["primitives"][0]; }

    std::size_t add_view(const std::string& bytes) {
        while (binary.size() % 4 != 0) binary += '\0';
        root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes.size()}});
        binary += bytes;
        return root["bufferViews"].size() - 1;
    }
    template <class T>
    std::size_t add(const std::vector<T>& values, int component_type, const std::string& type) {
        std::string bytes(values.size() * sizeof(T), '\0');
        std::memcpy(bytes.data(), values.data(), bytes.size());
        const std::size_t view = add_view(bytes);
        const std::size_t components = type == "SCALAR" ? 1 : static_cast<std::size_t>(type[3] - '0');
        root["accessors"].push_back({{"bufferView", view},
                                     {"componentType", component_type},
                                     {"count", values.size() / components},
                                     {"type", type}});
        return root["accessors"].size() - 1;
    }

    /// The text of a .gltf whose buffer is the file `uri`.
    std::string text(const std::string& uri) const {
        nlohmann::json document = root;
        document["buffers"] = {{{"byteLength", binary.size()}, {"uri", uri}}};
        return document.dump();
    }
    std::string glb() const {
        nlohmann::json document = root;
        document["buffers"] = {{{"byteLength", binary.size()}}};
        std::string json_chunk = document.dump();
        while (json_chunk.size() % 4 != 0) json_chunk += ' ';
        std::string binary_chunk = binary;
        while (binary_chunk.size() % 4 != 0) binary_chunk += '\0';
        const std::size_t total = 12 + 8 + json_chunk.size() + 8 + binary_chunk.size();
        return "glTF" + u32(2) + u32(total) + u32(json_chunk.size()) + "JSON" + json_chunk + u32(binary_chunk.size()) +
               std::string("BIN\0", 4) + binary_chunk;
    }
    static std::string u32(std::size_t value) {
        std::string bytes;
        for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 0xff);
        return bytes;
    }
};

}  // namespace matchlight
