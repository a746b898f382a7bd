// CSV: a line of column names, then a line a sphere, separated by commas, semicolons, tabs or spaces.
#include <string>
#include <vector>

#include <fmt/format.h>

#include "scene/element_table.h"
#include "scene/sphere_readers.h"
#include "scene/text_fields.h"

namespace matchlight {
namespace {

struct CsvColumn {
    int axis = -1;  // 0 to 2: of the place
    bool is_element = false;
    SphereValues wanted;

    bool is_read() const { return axis >= 0 || is_element || wanted.any(); }
};

constexpr char any_blanks = ' ';

char separator_of(std::string_view names) {
    for (const char separator : {',', ';', '\t'}) {
        if (names.find(separator) != std::string_view::npos) return separator;
    }
    return any_blanks;
}

/// Takes the next field off the front of `rest`; nullopt where there is none.
std::optional<std::string_view> next_field(std::optional<std::string_view>& rest, char separator) {
    if (!rest) return std::nullopt;
    if (separator == any_blanks) {
        const std::string_view word = next_word(*rest);
        return word.empty() ? std::nullopt : std::optional(word);
    }
    const std::size_t end = rest->find(separator);
    std::string_view field = trimmed(rest->substr(0, end));
    if (end == std::string_view::npos) {
        rest.reset();
    } else {
        rest->remove_prefix(end + 1);
    }
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
    return field;
}

/// Names that say the place: x, y, z, and ParaView's "Points:0" or "Points_0".
int axis_of(std::string_view name) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<std::size_t>(axis);
        const std::string_view small = "xyz", large = "XYZ";
        if (name == small.substr(i, 1) || name == large.substr(i, 1)) return axis;
        if (name == fmt::format("Points:{}", axis) || name == fmt::format("Points_{}", axis)) return axis;
    }
    return -1;
}

bool is_passed_over(std::string_view line) {
    const std::string_view text = trimmed(line);
    return text.empty() || text.starts_with('#');
}

std::vector<CsvColumn> columns_in(const ChunkedFile& file, std::string_view names, char separator,
                                  SphereBuilder& builder) {
    std::vector<CsvColumn> columns;
    int axes = 0;
    std::optional<std::string_view> rest = names;
    while (const auto name = next_field(rest, separator)) {
        CsvColumn column;
        column.axis = axis_of(*name);
        column.is_element = *name == "element" || *name == "symbol" || *name == "species";
        if (column.axis >= 0) axes |= 1 << column.axis;
        if (column.is_element) builder.have_elements(1);
        if (!column.is_element) column.wanted = builder.claim(std::string(*name));
        columns.push_back(column);
    }
    if (axes != 7) {
        file.fail("it does not name the columns x, y and z", "begin with a line such as x,y,z,radius");
    }
    return columns;
}

SphereRecord record_in(const ChunkedFile& file, std::string_view line, char separator,
                       const std::vector<CsvColumn>& columns) {
    SphereRecord record;
    record.line = file.line_number();
    std::optional<std::string_view> rest = line;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const CsvColumn& column = columns[i];
        const auto field = next_field(rest, separator);
        if (!field) file.fail(fmt::format("it has {} of {} columns", i, columns.size()));
        if (!column.is_read()) continue;
        if (column.is_element) {
            record.element = atomic_number(*field);
            continue;
        }
        const auto number = number_in(*field);
        if (!number) file.fail(fmt::format("'{}' is no number", field->substr(0, 40)));
        if (column.axis >= 0) record.centre[static_cast<std::size_t>(column.axis)] = *number;
        record.put(column.wanted, *number);
    }
    return record;
}

}  // namespace

void read_csv_spheres(ChunkedFile& file, SphereBuilder& builder) {
    std::string_view names = trimmed(file.needed_line("its column names"));
    if (names.starts_with("\xef\xbb\xbf")) names.remove_prefix(3);  // a byte order mark
    if (names.starts_with('#')) names = trimmed(names.substr(1));
    const char separator = separator_of(names);
    const std::vector<CsvColumn> columns = columns_in(file, names, separator, builder);
    builder.begin(std::nullopt);
    while (const auto line = file.line()) {
        if (!is_passed_over(*line)) builder.add(record_in(file, *line, separator, columns));
    }
}

}  // namespace matchlight
