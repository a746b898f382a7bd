// XYZ, plain (symbol, x, y, z and whatever follows) and extended (columns named by Properties=).
#include <string>
#include <vector>

#include <fmt/format.h>

#include "scene/element_table.h"
#include "scene/sphere_readers.h"
#include "scene/text_fields.h"

namespace matchlight {
namespace {

/// What one word of a line is.
struct XyzField {
    int axis = -1;  // 0 to 2: of the place
    bool is_element = false;
    SphereValues wanted;
};

/// "species:S:1:pos:R:3:radius:R:1" of a comment; empty where it has none.
std::string_view properties_in(std::string_view comment) {
    const std::size_t at = comment.find("Properties=");
    if (at == std::string_view::npos) return {};
    std::string_view rest = comment.substr(at + std::string_view("Properties=").size());
    if (rest.starts_with('"')) {
        rest.remove_prefix(1);
        return rest.substr(0, rest.find('"'));
    }
    return next_word(rest);
}

std::vector<XyzField> extended_fields(const ChunkedFile& file, std::string_view properties, SphereBuilder& builder) {
    std::vector<std::string_view> parts;
    while (true) {
        const std::size_t end = properties.find(':');
        parts.push_back(properties.substr(0, end));
        if (end == std::string_view::npos) break;
        properties.remove_prefix(end + 1);
    }
    if (parts.size() % 3 != 0) file.fail("Properties= is no list of name:type:columns");
    std::vector<XyzField> fields;
    bool has_place = false;
    for (std::size_t i = 0; i < parts.size(); i += 3) {
        const std::string name(parts[i]);
        const auto columns = count_in(parts[i + 2]);
        constexpr std::uint64_t most_columns = 1000;
        if (!columns || *columns < 1 || *columns > most_columns) {
            file.fail(fmt::format("Properties= gives '{}' no number of columns", name));
        }
        const bool is_place = (name == "pos" || name == "positions") && *columns == 3;
        const bool is_element = name == "species" || name == "element" || name == "Z";
        has_place = has_place || is_place;
        if (is_element) builder.have_elements(1);
        for (std::uint64_t c = 0; c < *columns; ++c) {
            XyzField field;
            if (is_place) {
                field.axis = static_cast<int>(c);
            } else if (is_element) {
                field.is_element = true;
            } else if (parts[i + 1] != "S") {
                field.wanted = builder.claim(*columns == 1 ? name : fmt::format("{}_{}", name, c));
            }
            fields.push_back(field);
        }
    }
    if (!has_place) file.fail("Properties= names no pos:R:3");
    return fields;
}

/// A line of plain XYZ says what there is by its number of words.
std::vector<XyzField> plain_fields(std::string_view first_line, SphereBuilder& builder) {
    std::vector<XyzField> fields{{.is_element = true, .wanted = {}},
                                 {.axis = 0, .wanted = {}},
                                 {.axis = 1, .wanted = {}},
                                 {.axis = 2, .wanted = {}}};
    builder.have_elements(1);
    std::size_t words = 0;
    while (!next_word(first_line).empty()) ++words;
    while (fields.size() < words) {
        fields.push_back({.wanted = builder.claim(fmt::format("column{}", fields.size() + 1))});
    }
    return fields;
}

SphereRecord record_in(const ChunkedFile& file, std::string_view line, const std::vector<XyzField>& fields) {
    SphereRecord record;
    record.line = file.line_number();
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const XyzField& field = fields[i];
        const std::string_view word = next_word(line);
        if (word.empty()) file.fail(fmt::format("it has {} of {} columns", i, fields.size()));
        if (field.is_element) record.element = atomic_number(word);
        if (field.axis < 0 && field.wanted.none()) continue;
        const auto number = number_in(word);
        if (!number) file.fail(fmt::format("'{}' is no number", word.substr(0, 40)));
        if (field.axis >= 0) record.centre[static_cast<std::size_t>(field.axis)] = *number;
        record.put(field.wanted, *number);
    }
    return record;
}

std::uint64_t count_line(ChunkedFile& file, std::int64_t frame) {
    const std::string_view line = file.needed_line(fmt::format("frame {}", frame));
    const auto count = count_in(trimmed(line));
    if (!count)
        file.fail(fmt::format("'{}' is no number of atoms", trimmed(line).substr(0, 40)),
                  "write how many follow, such as 3");
    constexpr std::uint64_t shortest_line = 8;  // "C 0 0 0" and its end
    file.check_count(*count, shortest_line, "atoms");
    return *count;
}

}  // namespace

void read_xyz_spheres(ChunkedFile& file, std::int64_t frame, SphereBuilder& builder) {
    std::uint64_t count = count_line(file, 0);
    for (std::int64_t passed = 0; passed < frame; ++passed) {
        for (std::uint64_t i = 0; i < count + 1; ++i) file.needed_line(fmt::format("frame {}", frame));
        count = count_line(file, passed + 1);
    }
    const std::string_view comment = file.needed_line("its second line");
    const std::string_view properties = properties_in(comment);
    const bool is_plain = properties.empty();
    std::vector<XyzField> fields;
    if (!is_plain) fields = extended_fields(file, properties, builder);
    if (is_plain && count == 0) builder.have_elements(1);
    if (!is_plain || count == 0) builder.begin(count);
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::string_view line = file.needed_line(fmt::format("atom {} of {}", i + 1, count));
        if (fields.empty()) {
            fields = plain_fields(line, builder);
            builder.begin(count);
        }
        builder.add(record_in(file, line, fields));
    }
}

}  // namespace matchlight
