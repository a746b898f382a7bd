// Container, JSON and buffers of glTF files.
#include "scene/gltf_document.h"

#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "core/error.h"
#include "core/memory.h"

namespace matchlight {
namespace {

using nlohmann::json;

/// Deeper JSON is no model; parsers that recurse would run out of stack.
constexpr int deepest_nesting = 200;
/// What the parsed form of a JSON text takes at most, as a multiple of it: an element "0," becomes 16 bytes.
constexpr std::uint64_t parsed_per_text = 32;

std::uint32_t little_endian_u32(std::string_view bytes, std::size_t offset) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + i])) << (8 * i);
    }
    return value;
}

bool nests_deeper_than(std::string_view text, int limit) {
    int depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\') ++i;
            if (c == '"') in_string = false;
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            if (++depth > limit) return true;
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
    return false;
}

/// RFC 4648; nullopt for any other character.
std::optional<std::string> base64_decoded(std::string_view text) {
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 3);
    std::uint32_t bits = 0;
    int bit_count = 0;
    for (const char c : text) {
        std::uint32_t value = 0;
        if (c >= 'A' && c <= 'Z') {
            value = static_cast<std::uint32_t>(c - 'A');
        } else if (c >= 'a' && c <= 'z') {
            value = static_cast<std::uint32_t>(c - 'a' + 26);
        } else if (c >= '0' && c <= '9') {
            value = static_cast<std::uint32_t>(c - '0' + 52);
        } else if (c == '+' || c == '-') {
            value = 62;
        } else if (c == '/' || c == '_') {
            value = 63;
        } else {
            return std::nullopt;
        }
        bits = bits << 6 | value;
        bit_count += 6;
        if (bit_count >= 8) {
            bit_count -= 8;
            bytes += static_cast<char>(bits >> bit_count & 0xff);
        }
    }
    return bytes;
}

}  // namespace

std::string place_in(const char* list, std::size_t index) {
    return fmt::format("{}[{}]", list, index);
}

GltfDocument::GltfDocument(const std::filesystem::path& path) : folder_{path} {
    const std::string file = read_binary_file(path);
    if (!std::string_view(file).starts_with("glTF")) {
        parse(file);
        load_buffers(std::nullopt);
        return;
    }
    if (file.size() < 20) fail("it ends inside its header");
    if (little_endian_u32(file, 4) != 2) fail("it is not glTF 2.0");
    const std::uint32_t stated = little_endian_u32(file, 8);
    if (stated > file.size()) fail(fmt::format("it ends after {} of {} bytes", file.size(), stated));
    std::optional<std::string_view> text;
    std::optional<std::string> binary;
    for (std::size_t offset = 12; offset + 8 <= stated;) {
        const std::size_t length = little_endian_u32(file, offset);
        const std::uint32_t type = little_endian_u32(file, offset + 4);
        if (length > stated - offset - 8) fail("a chunk reaches beyond its end");
        const std::string_view chunk = std::string_view(file).substr(offset + 8, length);
        if (type == 0x4e4f534a && !text) text = chunk;                   // "JSON"
        if (type == 0x004e4942 && !binary) binary = std::string(chunk);  // "BIN\0"
        offset += 8 + length;
    }
    if (!text) fail("it has no JSON chunk");
    parse(*text);
    load_buffers(std::move(binary));
}

void GltfDocument::fail(const std::string& cause, const std::string& cure) const {
    throw InputError(folder_.model, cause, cure);
}

void GltfDocument::parse(std::string_view text) {
    if (nests_deeper_than(text, deepest_nesting)) fail(fmt::format("its JSON nests deeper than {}", deepest_nesting));
    if (text.size() > available_memory_bytes() / parsed_per_text) {
        fail(fmt::format("its JSON of {} MB does not fit into memory", text.size() >> 20));
    }
    try {
        root_ = json::parse(text);
    } catch (const json::exception& error) {
        fail(fmt::format("its JSON is broken: {}", error.what()));
    }
    if (!root_.is_object()) fail("its JSON is no object");
    const json asset = root_.value("asset", json::object());
    if (!asset.is_object()) fail("'asset' is no object");
    const std::string version = text_of(asset, "version", "asset");
    if (!version.starts_with("2.")) fail(fmt::format("it is glTF '{}', not 2.0", version.substr(0, 20)));
}

void GltfDocument::load_buffers(std::optional<std::string> binary_chunk) {
    for (std::size_t i = 0; i < list("buffers").size(); ++i) {
        const std::string where = place_in("buffers", i);
        const json& buffer = item("buffers", i);
        const std::uint64_t length = unsigned_of(buffer, "byteLength", where);
        std::string bytes;
        if (buffer.contains("uri")) {
            UriContents contents = resolve(text_of(buffer, "uri", where), where);
            std::error_code failure;
            if (!contents.file.empty() && !std::filesystem::is_regular_file(contents.file, failure)) {
                fail(fmt::format("{}: there is no file '{}'", where, contents.file.string()));
            }
            bytes = contents.file.empty() ? std::move(contents.bytes) : read_binary_file(contents.file);
        } else if (i == 0 && binary_chunk) {
            bytes = std::move(*binary_chunk);
        } else {
            fail(where + " has no contents");
        }
        if (bytes.size() < length) fail(fmt::format("{} has {} of {} bytes", where, bytes.size(), length));
        bytes.resize(length);
        buffers_.push_back(std::move(bytes));
    }
}

const json& GltfDocument::list(const char* name) const {
    static const json none = json::array();
    const auto found = root_.find(name);
    if (found == root_.end()) return none;
    if (!found->is_array()) fail(fmt::format("'{}' is no array", name));
    return *found;
}

const json& GltfDocument::item(const char* name, std::size_t index) const {
    const json& element = list(name).at(index);
    if (!element.is_object()) fail(place_in(name, index) + " is no object");
    return element;
}

std::uint64_t GltfDocument::unsigned_of(const json& object, const char* key, const std::string& where,
                                        std::optional<std::uint64_t> fallback) const {
    const auto found = object.find(key);
    if (found == object.end()) {
        if (fallback) return *fallback;
        fail(fmt::format("{}.{} is missing", where, key));
    }
    // Beyond this a JSON number is not exact, and sums of a few of them stay far from overflow.
    constexpr std::uint64_t largest = 1ull << 53;
    if (!found->is_number_unsigned() || found->get<std::uint64_t>() > largest) {
        fail(fmt::format("{}.{} is no whole number from 0 to 2^53", where, key));
    }
    return found->get<std::uint64_t>();
}

std::optional<std::size_t> GltfDocument::index_of(const json& object, const char* key, const char* into,
                                                  const std::string& where) const {
    if (!object.contains(key)) return std::nullopt;
    const std::uint64_t index = unsigned_of(object, key, where);
    const std::size_t size = list(into).size();
    if (index >= size) fail(fmt::format("{}.{} is {}, but there are {} {}", where, key, index, size, into));
    return static_cast<std::size_t>(index);
}

double GltfDocument::number_of(const json& object, const char* key, double fallback, const std::string& where) const {
    const auto found = object.find(key);
    if (found == object.end()) return fallback;
    if (!found->is_number()) fail(fmt::format("{}.{} is no number", where, key));
    return found->get<double>();
}

json GltfDocument::numbers_of(const json& object, const char* key, std::size_t size, const std::string& where) const {
    const auto found = object.find(key);
    if (found == object.end()) return nullptr;
    bool good = found->is_array() && found->size() == size;
    if (good) {
        for (const json& number : *found) good = good && number.is_number();
    }
    if (!good) fail(fmt::format("{}.{} is not {} numbers", where, key, size));
    return *found;
}

std::string GltfDocument::text_of(const json& object, const char* key, const std::string& where) const {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_string()) fail(fmt::format("{}.{} is no text", where, key));
    return found->get<std::string>();
}

GltfDocument::UriContents GltfDocument::resolve(const std::string& uri, const std::string& where) const {
    if (!uri.starts_with("data:")) return {"", folder_.inside(percent_decoded(uri))};
    const std::size_t comma = uri.find(',');
    if (comma == std::string::npos) fail(where + ".uri is a data URI without data");
    const std::string_view header = std::string_view(uri).substr(0, comma);
    const std::string_view data = std::string_view(uri).substr(comma + 1);
    if (!header.ends_with(";base64")) return {percent_decoded(data), {}};
    auto bytes = base64_decoded(data);
    if (!bytes) fail(where + ".uri is not base64");
    return {std::move(*bytes), {}};
}

}  // namespace matchlight
