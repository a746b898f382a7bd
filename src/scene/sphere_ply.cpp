// PLY: the element `vertex`, in ASCII or binary of either byte order.
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "scene/binary_number.h"
#include "scene/sphere_readers.h"
#include "scene/text_fields.h"

namespace matchlight {
namespace {

struct PlyField {
    std::string name;
    NumberType type = NumberType::float32;
    int axis = -1;  // 0 to 2: of the place
    SphereValues wanted;

    bool is_read() const { return axis >= 0 || wanted.any(); }
};

struct PlyItems {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyField> fields;
    bool has_lists = false;

    std::size_t bytes() const {
        std::size_t sum = 0;
        for (const PlyField& field : fields) sum += bytes_of(field.type);
        return sum;
    }
};

struct PlyHeader {
    bool is_text = false;
    bool is_big_endian = false;
    std::vector<PlyItems> elements;  // up to the vertices

    PlyItems& vertices() { return elements.back(); }
};

NumberType type_named(const ChunkedFile& file, std::string_view name) {
    static const std::map<std::string_view, NumberType> types = {
        {"char", NumberType::int8},       {"int8", NumberType::int8},       {"uchar", NumberType::uint8},
        {"uint8", NumberType::uint8},     {"short", NumberType::int16},     {"int16", NumberType::int16},
        {"ushort", NumberType::uint16},   {"uint16", NumberType::uint16},   {"int", NumberType::int32},
        {"int32", NumberType::int32},     {"uint", NumberType::uint32},     {"uint32", NumberType::uint32},
        {"float", NumberType::float32},   {"float32", NumberType::float32}, {"double", NumberType::float64},
        {"float64", NumberType::float64},
    };
    const auto found = types.find(name);
    if (found == types.end()) file.fail(fmt::format("unknown type '{}'", name.substr(0, 40)));
    return found->second;
}

void read_format(const ChunkedFile& file, std::string_view format, PlyHeader& header) {
    header.is_text = format == "ascii";
    header.is_big_endian = format == "binary_big_endian";
    if (!header.is_text && !header.is_big_endian && format != "binary_little_endian") {
        file.fail(fmt::format("unknown format '{}'", format.substr(0, 40)));
    }
}

void read_property(const ChunkedFile& file, std::string_view words, PlyItems& items) {
    const std::string_view type = next_word(words);
    if (type == "list") {
        items.has_lists = true;
        return;
    }
    PlyField field;
    field.type = type_named(file, type);
    field.name = next_word(words);
    items.fields.push_back(std::move(field));
}

PlyHeader read_header(ChunkedFile& file) {
    if (trimmed(file.needed_line("its header")) != "ply") file.fail("it is no PLY file");
    PlyHeader header;
    bool has_vertices = false, is_past_them = false, has_format = false;
    while (true) {
        std::string_view line = file.needed_line("the end of its header");
        const std::string_view keyword = next_word(line);
        if (keyword == "end_header") break;
        if (keyword == "format") {
            read_format(file, next_word(line), header);
            has_format = true;
        } else if (keyword == "element") {
            is_past_them = has_vertices;
            if (is_past_them) continue;
            PlyItems items;
            items.name = next_word(line);
            const auto count = count_in(next_word(line));
            if (!count) file.fail(fmt::format("element '{}' has no count", items.name));
            items.count = *count;
            has_vertices = items.name == "vertex";
            header.elements.push_back(std::move(items));
        } else if (keyword == "property" && !is_past_them) {
            if (header.elements.empty()) file.fail("a property before any element");
            read_property(file, line, header.elements.back());
        }
    }
    if (!has_format) file.fail("its header has no format");
    if (!has_vertices) file.fail("its header has no element vertex");
    if (header.vertices().has_lists) file.fail("its vertices hold lists, which spheres do not");
    return header;
}

void pass_over(ChunkedFile& file, const PlyHeader& header, const PlyItems& items) {
    if (header.is_text) {
        for (std::uint64_t i = 0; i < items.count; ++i) file.needed_line("its vertices");
        return;
    }
    if (items.has_lists) throw InputError(file.path(), "its vertices come after lists", "put the vertices first");
    file.check_count(items.count, items.bytes() == 0 ? 1 : items.bytes(), items.name);
    file.skip(items.count * items.bytes(), items.name);
}

void claim_fields(const ChunkedFile& file, std::vector<PlyField>& fields, SphereBuilder& builder) {
    int axes = 0;
    for (PlyField& field : fields) {
        const std::size_t axis = std::string_view("xyz").find(field.name);
        if (field.name.size() == 1 && axis != std::string_view::npos) {
            field.axis = static_cast<int>(axis);
            axes |= 1 << field.axis;
        }
        field.wanted =
            builder.claim(field.name, field.type == NumberType::uint8 ? ColumnKind::byte : ColumnKind::number);
    }
    if (axes != 7) throw InputError(file.path(), "its vertices have no x, y and z");
}

void put(SphereRecord& record, const PlyField& field, double number) {
    if (field.axis >= 0) record.centre[static_cast<std::size_t>(field.axis)] = number;
    record.put(field.wanted, number);
}

SphereRecord text_record(ChunkedFile& file, const std::vector<PlyField>& fields) {
    std::string_view line = file.needed_line("the last of its vertices");
    SphereRecord record;
    record.line = file.line_number();
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const std::string_view word = next_word(line);
        if (word.empty()) file.fail(fmt::format("it has {} of {} properties", i, fields.size()));
        if (!fields[i].is_read()) continue;
        const auto number = number_in(word);
        if (!number) file.fail(fmt::format("'{}' is no number", word.substr(0, 40)));
        put(record, fields[i], *number);
    }
    return record;
}

}  // namespace

void read_ply_spheres(ChunkedFile& file, SphereBuilder& builder) {
    PlyHeader header = read_header(file);
    for (std::size_t i = 0; i + 1 < header.elements.size(); ++i) pass_over(file, header, header.elements[i]);
    const PlyItems& vertices = header.vertices();
    std::vector<PlyField> fields = vertices.fields;
    claim_fields(file, fields, builder);
    // A word of text has a digit and a separator.
    const std::size_t row_bytes = vertices.bytes();
    file.check_count(vertices.count, header.is_text ? 2 * fields.size() : row_bytes, "vertices");
    builder.begin(vertices.count);
    for (std::uint64_t i = 0; i < vertices.count; ++i) {
        if (header.is_text) {
            builder.add(text_record(file, fields));
            continue;
        }
        const char* at = file.bytes(row_bytes, "its vertices").data();
        SphereRecord record;
        for (const PlyField& field : fields) {
            if (field.is_read()) put(record, field, number_at(at, field.type, header.is_big_endian));
            at += bytes_of(field.type);
        }
        builder.add(record);
    }
}

}  // namespace matchlight
