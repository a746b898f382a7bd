// Checks PLY and STL files: what their headers promise is there.
#include <charconv>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <sstream>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "core/memory.h"
#include "scene/checked_model.h"
#include "scene/confined_path.h"

namespace matchlight {
namespace {

struct PlyProperty {
    std::size_t bytes = 0;        // of the value, or of a list's items
    std::size_t count_bytes = 0;  // of a list's length; 0: no list
    bool is_float = false;
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;

    bool has_list() const {
        for (const PlyProperty& property : properties) {
            if (property.count_bytes > 0) return true;
        }
        return false;
    }
    /// With empty lists.
    std::uint64_t smallest_bytes() const {
        std::uint64_t sum = 0;
        for (const PlyProperty& property : properties) {
            sum += property.count_bytes > 0 ? property.count_bytes : property.bytes;
        }
        return sum;
    }
};

class PlyChecker {
public:
    explicit PlyChecker(const std::filesystem::path& path) : path_(path), bytes_(read_binary_file(path)) {}

    CheckedModel check() {
        read_header();
        const std::uint64_t left = bytes_.size() - data_;
        for (const PlyElement& element : elements_) {
            // A line of text holds at least a digit and a separator for each property.
            const std::uint64_t smallest = is_text_ ? 2 * element.properties.size() : element.smallest_bytes();
            if (smallest > 0 && element.count > (left + 1) / smallest) {
                fail(fmt::format("its header promises {} of '{}', more than its {} bytes hold", element.count,
                                 element.name, left));
            }
        }
        if (!is_text_) walk_binary();
        return {path_, "model.ply", {{"model.ply", std::move(bytes_)}}, {}};
    }

private:
    [[noreturn]] void fail(const std::string& cause) const { throw InputError(path_, cause); }
    void read_header();
    void walk_binary() const;
    std::size_t type_bytes(const std::string& type) const {
        static const std::map<std::string, std::size_t> sizes = {
            {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
            {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
            {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
        const auto found = sizes.find(type);
        if (found == sizes.end()) fail(fmt::format("its header has the unknown type '{}'", type.substr(0, 40)));
        return found->second;
    }
    std::uint64_t unsigned_at(std::size_t offset, std::size_t bytes) const {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < bytes; ++i) {
            const auto byte = static_cast<unsigned char>(bytes_[offset + (is_big_endian_ ? i : bytes - 1 - i)]);
            value = value << 8 | byte;
        }
        return value;
    }

    std::filesystem::path path_;
    std::string bytes_;
    std::vector<PlyElement> elements_;
    std::size_t data_ = 0;  // where the header ends
    bool is_text_ = false;
    bool is_big_endian_ = false;
};

void PlyChecker::read_header() {
    constexpr std::size_t longest_header = 1u << 16;
    const std::string_view start = std::string_view(bytes_).substr(0, longest_header);
    if (!start.starts_with("ply")) fail("it is no PLY file");
    const std::size_t end = start.find("end_header");
    const std::size_t line_end = end == std::string_view::npos ? end : start.find('\n', end);
    if (line_end == std::string_view::npos) fail("its header does not end");
    data_ = line_end + 1;

    std::istringstream header{std::string(start.substr(0, end))};
    header.imbue(std::locale::classic());
    std::string line;
    bool has_format = false;
    while (std::getline(header, line)) {
        std::istringstream words(line);
        words.imbue(std::locale::classic());
        std::string keyword;
        words >> keyword;
        if (keyword == "format") {
            std::string format;
            words >> format;
            is_text_ = format == "ascii";
            is_big_endian_ = format == "binary_big_endian";
            if (!is_text_ && !is_big_endian_ && format != "binary_little_endian") fail("its format is unknown");
            has_format = true;
        } else if (keyword == "element") {
            PlyElement element;
            if (!(words >> element.name >> element.count)) fail("an element of its header has no count");
            elements_.push_back(std::move(element));
        } else if (keyword == "property") {
            if (elements_.empty()) fail("its header has a property before any element");
            std::string type;
            PlyProperty property;
            words >> type;
            if (type == "list") {
                std::string count_type;
                words >> count_type >> type;
                property.count_bytes = type_bytes(count_type);
            }
            property.bytes = type_bytes(type);
            property.is_float = type.starts_with("float") || type.starts_with("double");
            elements_.back().properties.push_back(property);
        }
    }
    if (!has_format) fail("its header has no format");
    // Counts are compared with the file's size; this keeps their products in range.
    for (const PlyElement& element : elements_) {
        if (element.count > (1ull << 40))
            fail(fmt::format("its header promises {} of '{}'", element.count, element.name));
    }
}

/// Follows the lists of a binary file to its end; vertex indices of faces are compared with the number of vertices.
void PlyChecker::walk_binary() const {
    std::uint64_t vertex_count = 0;
    for (const PlyElement& element : elements_) {
        if (element.name == "vertex") vertex_count = element.count;
    }
    std::size_t offset = data_;
    const auto advance = [&](std::uint64_t bytes, const PlyElement& element, std::uint64_t number) {
        if (bytes > bytes_.size() - offset) {
            fail(fmt::format("it ends inside '{}' number {} of {}", element.name, number, element.count));
        }
        offset += bytes;
    };
    for (const PlyElement& element : elements_) {
        if (!element.has_list()) {
            advance(element.count * element.smallest_bytes(), element, 0);
            continue;
        }
        for (std::uint64_t number = 0; number < element.count; ++number) {
            for (const PlyProperty& property : element.properties) {
                if (property.count_bytes == 0) {
                    advance(property.bytes, element, number);
                    continue;
                }
                const std::size_t count_at = offset;
                advance(property.count_bytes, element, number);
                const std::uint64_t items = unsigned_at(count_at, property.count_bytes);
                if (items > bytes_.size())
                    fail(fmt::format("a list of '{}' number {} is too long", element.name, number));
                const std::size_t items_at = offset;
                advance(items * property.bytes, element, number);
                if (element.name != "face" || property.is_float || items < 3) continue;
                for (std::uint64_t i = 0; i < items; ++i) {
                    const std::uint64_t index = unsigned_at(items_at + i * property.bytes, property.bytes);
                    if (index >= vertex_count) {
                        fail(fmt::format("face {} has vertex {}, but there are {}", number, index, vertex_count));
                    }
                }
            }
        }
    }
}

}  // namespace

CheckedModel check_ply(const std::filesystem::path& path) {
    return PlyChecker(path).check();
}

CheckedModel check_stl(const std::filesystem::path& path) {
    std::string bytes = read_binary_file(path);
    // Binary files may start with "solid" too; only text is without zero bytes.
    const bool is_text = std::string_view(bytes).starts_with("solid") && bytes.find('\0') == std::string::npos;
    if (!is_text) {
        constexpr std::size_t header_bytes = 84;
        constexpr std::size_t triangle_bytes = 50;
        if (bytes.size() < header_bytes) throw InputError(path, "it is no STL file");
        std::uint64_t triangles = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            triangles |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[80 + i])) << (8 * i);
        }
        const std::uint64_t held = (bytes.size() - header_bytes) / triangle_bytes;
        if (triangles > held) {
            throw InputError(path, fmt::format("it holds {} of the {} triangles its header promises", held, triangles));
        }
        bytes.resize(header_bytes + triangles * triangle_bytes);  // assimp takes no binary file with more after them
    }
    return {path, "model.stl", {{"model.stl", std::move(bytes)}}, {}};
}

}  // namespace matchlight
