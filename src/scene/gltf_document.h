// A glTF file as JSON and bytes, read without trusting any of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "scene/confined_path.h"

namespace matchlight {

/// The JSON of a .gltf or .glb file with the contents of its buffers. Every accessor here throws InputError naming the
/// file and the place in it: "buffers[2].byteLength".
class GltfDocument {
public:
    /// Reads the file and its buffers. Throws InputError: not glTF 2, truncated, JSON nested deeper than 200, a buffer
    /// that is missing, too short, or not inside the model's folder.
    explicit GltfDocument(const std::filesystem::path& path);

    const std::filesystem::path& path() const { return folder_.model; }
    const nlohmann::json& root() const { return root_; }
    const std::vector<std::string>& buffers() const { return buffers_; }

    [[noreturn]] void fail(const std::string& cause, const std::string& cure = {}) const;

    /// A top-level array; an empty one where the file has none.
    const nlohmann::json& list(const char* name) const;
    /// An element of a list that must be an object; `name` and `index` for messages.
    const nlohmann::json& item(const char* name, std::size_t index) const;

    // Members of `object`, which is called `where` in messages. An absent one is the fallback.
    std::uint64_t unsigned_of(const nlohmann::json& object, const char* key, const std::string& where,
                              std::optional<std::uint64_t> fallback = std::nullopt) const;
    /// An index into the top-level array `into`; nullopt where it is absent.
    std::optional<std::size_t> index_of(const nlohmann::json& object, const char* key, const char* into,
                                        const std::string& where) const;
    double number_of(const nlohmann::json& object, const char* key, double fallback, const std::string& where) const;
    /// An array of `size` numbers, or null where it is absent.
    nlohmann::json numbers_of(const nlohmann::json& object, const char* key, std::size_t size,
                              const std::string& where) const;
    std::string text_of(const nlohmann::json& object, const char* key, const std::string& where) const;

    struct UriContents {
        std::string bytes;           // of a data URI
        std::filesystem::path file;  // of any other; it may be missing
    };
    UriContents resolve(const std::string& uri, const std::string& where) const;

private:
    void parse(std::string_view text);
    void load_buffers(std::optional<std::string> binary_chunk);

    ModelFolder folder_;
    nlohmann::json root_;
    std::vector<std::string> buffers_;
};

/// "accessors[3]"
std::string place_in(const char* list, std::size_t index);

}  // namespace matchlight
