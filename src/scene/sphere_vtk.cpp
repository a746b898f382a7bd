// Legacy VTK: the points of polygonal data and unstructured grids with their point data, ASCII or binary (Schroeder,
// Martin & Lorensen, "The Visualization Toolkit", file formats; binary is big-endian).
#include <array>
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

/// So many numbers of one type, one tuple after the other.
struct VtkArray {
    std::string name;
    std::uint64_t tuples = 0, components = 1;
    NumberType type = NumberType::float32;
};

class VtkReader {
public:
    VtkReader(ChunkedFile& file, SphereBuilder& builder) : file_(file), builder_(builder) {}

    void read() {
        read_header();
        while (auto line = file_.line()) {
            const std::string keyword(next_word(*line));
            if (!keyword.empty()) read_section(keyword, *line);
        }
        if (!has_points_) throw InputError(file_.path(), "it has no POINTS");
    }

private:
    void read_header() {
        if (!file_.needed_line("its header").starts_with("# vtk DataFile Version")) file_.fail("it is no VTK file");
        file_.needed_line("its header");  // the title
        const std::string_view format = trimmed(file_.needed_line("ASCII or BINARY"));
        is_text_ = format == "ASCII";
        if (!is_text_ && format != "BINARY") file_.fail("the line says neither ASCII nor BINARY");
    }
    void read_section(const std::string& keyword, std::string_view words);
    void read_points(std::string_view words);
    void read_cells(std::string_view words);
    void read_point_array(const VtkArray& array);
    void pass_over(const VtkArray& array) {
        read_numbers(array, [](std::uint64_t, double) {});
    }
    void read_data_array(const VtkArray& array) {
        if (in_point_data_) {
            read_point_array(array);
        } else {
            pass_over(array);
        }
    }
    template <class Take>
    void read_numbers(const VtkArray& array, const Take& take);

    std::uint64_t count_from(std::string_view& words) const {
        const std::string_view word = next_word(words);
        const auto count = count_in(word);
        // Products of two counts stay in range; the file is shorter anyway.
        if (!count || *count > std::uint64_t{1} << 40) file_.fail(fmt::format("'{}' is no count", word.substr(0, 40)));
        return *count;
    }
    NumberType type_from(std::string_view& words) const;

    ChunkedFile& file_;
    SphereBuilder& builder_;
    bool is_text_ = false, has_points_ = false, in_point_data_ = false;
    std::uint64_t points_ = 0, data_tuples_ = 0;
};

NumberType VtkReader::type_from(std::string_view& words) const {
    static const std::map<std::string_view, NumberType> types = {
        {"char", NumberType::int8},
        {"signed_char", NumberType::int8},
        {"unsigned_char", NumberType::uint8},
        {"short", NumberType::int16},
        {"unsigned_short", NumberType::uint16},
        {"int", NumberType::int32},
        {"unsigned_int", NumberType::uint32},
        {"long", NumberType::int64},
        {"unsigned_long", NumberType::uint64},
        {"vtktypeint64", NumberType::int64},
        {"vtktypeuint64", NumberType::uint64},
        {"vtkIdType", NumberType::int32},
        {"float", NumberType::float32},
        {"double", NumberType::float64},
    };
    const std::string_view word = next_word(words);
    const auto found = types.find(word);
    if (found == types.end()) file_.fail(fmt::format("numbers of the type '{}' are not read", word.substr(0, 40)));
    return found->second;
}

/// Calls `take` with each number and its index.
template <class Take>
void VtkReader::read_numbers(const VtkArray& array, const Take& take) {
    const std::uint64_t count = array.tuples * array.components;
    const std::size_t bytes = bytes_of(array.type);
    file_.check_count(count, is_text_ ? 2 : bytes, fmt::format("numbers of '{}'", array.name));
    const std::string wanted = fmt::format("the numbers of '{}'", array.name);
    std::string_view line;
    for (std::uint64_t i = 0; i < count; ++i) {
        if (!is_text_) {
            take(i, number_at(file_.bytes(bytes, wanted).data(), array.type, true));
            continue;
        }
        std::string_view word = next_word(line);
        while (word.empty()) {
            line = file_.needed_line(wanted);
            word = next_word(line);
        }
        const auto number = number_in(word);
        if (!number) file_.fail(fmt::format("'{}' is no number of '{}'", word.substr(0, 40), array.name));
        take(i, *number);
    }
}

void VtkReader::read_points(std::string_view words) {
    if (has_points_) file_.fail("it has POINTS twice");
    VtkArray array{.name = "POINTS", .tuples = count_from(words), .components = 3};
    array.type = type_from(words);
    has_points_ = true;
    points_ = array.tuples;
    file_.check_count(points_, is_text_ ? 6 : 3 * bytes_of(array.type), "points");
    builder_.begin_columns(points_);
    std::array<double, 3> centre{};
    read_numbers(array, [&](std::uint64_t i, double number) {
        centre[i % 3] = number;
        if (i % 3 == 2) builder_.set_centre(i / 3, centre);
    });
}

void VtkReader::read_point_array(const VtkArray& array) {
    if (!has_points_) file_.fail("its point data come before its POINTS");
    if (array.tuples != points_) {
        file_.fail(fmt::format("'{}' has {} values for {} points", array.name, array.tuples, points_));
    }
    const ColumnKind kind = array.type == NumberType::uint8 ? ColumnKind::byte : ColumnKind::number;
    std::vector<SphereValues> wanted;
    for (std::uint64_t c = 0; c < array.components; ++c) {
        wanted.push_back(
            builder_.claim(array.components == 1 ? array.name : fmt::format("{}_{}", array.name, c), kind));
    }
    read_numbers(array, [&](std::uint64_t i, double number) {
        const SphereValues values = wanted[i % array.components];
        if (values.any()) builder_.set(i / array.components, values, number);
    });
}

/// Before version 5 one list; from then on offsets and connectivity, each with a line of its own.
void VtkReader::read_cells(std::string_view words) {
    const std::uint64_t cells = count_from(words), numbers = count_from(words);
    const auto next = file_.peek();
    if (next != 'O') return pass_over({.name = "cells", .tuples = numbers, .type = NumberType::int32});
    for (const std::uint64_t count : {cells, numbers}) {
        std::string_view line = file_.needed_line("its cells");
        while (trimmed(line).empty()) line = file_.needed_line("its cells");
        next_word(line);
        pass_over({.name = "cells", .tuples = count, .type = type_from(line)});
    }
}

void VtkReader::read_section(const std::string& keyword, std::string_view words) {
    constexpr std::uint64_t most_components = 1000;
    const auto components_from = [&](std::string_view& from) {
        const std::uint64_t components = count_from(from);
        if (components < 1 || components > most_components) file_.fail("a wrong number of components");
        return components;
    };
    VtkArray array;
    array.tuples = points_;
    if (keyword == "DATASET") {
        const std::string_view kind = next_word(words);
        if (kind == "POLYDATA" || kind == "UNSTRUCTURED_GRID") return;
        file_.fail(fmt::format("a data set of the kind '{}' has no spheres", kind.substr(0, 40)),
                   "use POLYDATA or UNSTRUCTURED_GRID");
    }
    if (keyword == "POINTS") return read_points(words);
    if (keyword == "CELL_TYPES") {
        return pass_over({.name = "cells", .tuples = count_from(words), .type = NumberType::int32});
    }
    for (const char* cells : {"CELLS", "VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS"}) {
        if (keyword == cells) return read_cells(words);
    }
    if (keyword == "POINT_DATA" || keyword == "CELL_DATA") {
        in_point_data_ = keyword == "POINT_DATA";
        data_tuples_ = count_from(words);
        return;
    }
    if (keyword == "METADATA") {
        while (const auto line = file_.line()) {
            if (trimmed(*line).empty()) return;
        }
        return;
    }
    if (keyword == "FIELD") {
        next_word(words);
        const std::uint64_t arrays = count_from(words);
        for (std::uint64_t i = 0; i < arrays; ++i) {
            std::string_view line = trimmed(file_.needed_line("the arrays of a FIELD"));
            while (line.empty() || line.starts_with("METADATA")) {
                if (line.starts_with("METADATA")) read_section("METADATA", {});
                line = trimmed(file_.needed_line("the arrays of a FIELD"));
            }
            array.name = next_word(line);
            array.components = components_from(line);
            array.tuples = count_from(line);
            array.type = type_from(line);
            read_data_array(array);
        }
        return;
    }
    array.tuples = data_tuples_;
    array.name = next_word(words);
    if (keyword == "SCALARS") {
        array.type = type_from(words);
        if (!trimmed(words).empty()) array.components = components_from(words);
        if (!file_.needed_line("LOOKUP_TABLE").starts_with("LOOKUP_TABLE")) file_.fail("it is no LOOKUP_TABLE");
    } else if (keyword == "VECTORS" || keyword == "NORMALS" || keyword == "TENSORS") {
        array.type = type_from(words);
        array.components = keyword == "TENSORS" ? 9 : 3;
    } else if (keyword == "TEXTURE_COORDINATES") {
        array.components = components_from(words);
        array.type = type_from(words);
    } else if (keyword == "COLOR_SCALARS") {
        array.components = components_from(words);
        array.type = is_text_ ? NumberType::float32 : NumberType::uint8;
        array.name = "color";
    } else if (keyword == "LOOKUP_TABLE") {
        array.tuples = count_from(words);
        array.components = 4;
        array.type = is_text_ ? NumberType::float32 : NumberType::uint8;
        return pass_over(array);
    } else {
        file_.fail(fmt::format("'{}' is not known", keyword.substr(0, 40)));
    }
    read_data_array(array);
}

}  // namespace

void read_vtk_spheres(ChunkedFile& file, SphereBuilder& builder) {
    VtkReader(file, builder).read();
}

}  // namespace matchlight
