// GRO of GROMACS: fixed columns, in nanometres; a trajectory is one frame after the other.
#include <string>

#include <fmt/format.h>

#include "scene/element_table.h"
#include "scene/sphere_readers.h"
#include "scene/text_fields.h"

namespace matchlight {
namespace {

constexpr std::size_t first_number = 20;  // after residue number and name, atom name and number, five columns each

/// Atoms have names, not elements: "CA" of residue "CA" is calcium, of any other a carbon.
int element_of_gro(std::string_view line) {
    const std::string_view residue = trimmed(line.substr(5, 5));
    std::string_view name = trimmed(line.substr(10, 5));
    while (!name.empty() && name.front() >= '0' && name.front() <= '9') name.remove_prefix(1);
    if (name.empty()) return 0;
    std::size_t letters = 0;
    while (letters < name.size() && ((name[letters] | 0x20) >= 'a' && (name[letters] | 0x20) <= 'z')) ++letters;
    const bool is_ion = residue == name || residue.starts_with(name.substr(0, letters));
    if (is_ion && letters == 2) return atomic_number(name.substr(0, 2));
    if (const int one = atomic_number(name.substr(0, 1))) return one;
    return letters >= 2 ? atomic_number(name.substr(0, 2)) : 0;
}

/// Numbers are as wide as their decimal points are apart, so that files may have more digits.
std::size_t width_of_numbers(const ChunkedFile& file, std::string_view line) {
    const std::size_t first = line.find('.', first_number);
    const std::size_t second = first == std::string_view::npos ? first : line.find('.', first + 1);
    if (second == std::string_view::npos) file.fail("its coordinates have no decimal points");
    return second - first;
}

std::uint64_t read_count(ChunkedFile& file, std::int64_t frame) {
    file.needed_line(fmt::format("frame {}", frame));  // the title
    const std::string_view text = trimmed(file.needed_line(fmt::format("frame {}", frame)));
    const auto count = count_in(text);
    if (!count)
        file.fail(fmt::format("'{}' is no number of atoms", text.substr(0, 40)), "write how many follow, such as 3");
    constexpr std::uint64_t shortest_line = first_number + 6;
    file.check_count(*count, shortest_line, "atoms");
    return *count;
}

}  // namespace

void read_gro_spheres(ChunkedFile& file, std::int64_t frame, SphereBuilder& builder) {
    builder.have_elements(0.1);
    const SphereValues velocity[] = {builder.claim("vx"), builder.claim("vy"), builder.claim("vz")};
    std::uint64_t count = read_count(file, 0);
    for (std::int64_t passed = 0; passed < frame; ++passed) {
        for (std::uint64_t i = 0; i < count + 1; ++i) file.needed_line(fmt::format("frame {}", frame));
        count = read_count(file, passed + 1);
    }
    builder.begin(count);
    std::size_t width = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::string_view line = file.needed_line(fmt::format("atom {} of {}", i + 1, count));
        if (line.size() < first_number) file.fail("it is too short for an atom");
        if (width == 0) width = width_of_numbers(file, line);
        const auto number_at = [&](std::size_t index, std::size_t columns) {
            const std::size_t start = first_number + index * width;
            return line.size() > start ? number_in(trimmed(line.substr(start, columns))) : std::nullopt;
        };
        SphereRecord record;
        record.line = file.line_number();
        record.element = element_of_gro(line);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto number = number_at(axis, width);
            if (!number) file.fail("it has no three coordinates");
            record.centre[axis] = *number;
            // Velocities, where there are any, have the same width and one digit more behind the point.
            if (velocity[axis].any()) record.put(velocity[axis], number_at(3 + axis, width).value_or(0));
        }
        builder.add(record);
    }
}

}  // namespace matchlight
