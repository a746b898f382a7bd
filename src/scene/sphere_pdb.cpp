// PDB: the fixed columns of ATOM and HETATM records, in ångström (wwPDB 2012, "Protein Data Bank Contents Guide" 3.3).
// gemmi would hold every atom with all its names, ten times what a sphere takes.
#include <string>

#include <fmt/format.h>

#include "scene/element_table.h"
#include "scene/sphere_readers.h"
#include "scene/text_fields.h"

namespace matchlight {
namespace {

/// Columns counted from 1, as the guide counts them; shorter where the line ends.
std::string_view columns(std::string_view line, std::size_t first, std::size_t last) {
    if (line.size() < first) return {};
    return trimmed(line.substr(first - 1, last - first + 1));
}

/// Columns 77 and 78 name the element; older files have it only in the atom's name, right-justified in 13 and 14.
int element_of_pdb(std::string_view line) {
    const std::string_view named = columns(line, 77, 78);
    if (const int known = named.empty() ? 0 : atomic_number(named)) return known;
    if (line.size() < 14) return 0;
    const std::string_view two = line.substr(12, 2);
    const bool has_one_letter = two[0] == ' ' || (two[0] >= '0' && two[0] <= '9');
    // Four-letter names of hydrogens begin a column early: "HG11" is no mercury.
    const bool is_hydrogen = two[0] == 'H' && line.starts_with("ATOM") && columns(line, 13, 16).size() == 4;
    if (is_hydrogen) return 1;
    return atomic_number(has_one_letter ? two.substr(1) : two);
}

}  // namespace

void read_pdb_spheres(ChunkedFile& file, std::int64_t frame, SphereBuilder& builder) {
    builder.have_elements(1);
    const SphereValues occupancy = builder.claim("occupancy");
    const SphereValues b_factor = builder.claim("b_factor");
    builder.begin(std::nullopt);

    std::int64_t models = 0, atoms = 0;
    while (const auto line = file.line()) {
        if (line->starts_with("MODEL ")) {
            if (++models > frame + 1) break;
            continue;
        }
        if (!line->starts_with("ATOM  ") && !line->starts_with("HETATM")) continue;
        if (models != frame + 1 && (models > 0 || frame > 0)) continue;
        ++atoms;
        SphereRecord record;
        record.line = file.line_number();
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::string_view text = columns(*line, 31 + 8 * axis, 38 + 8 * axis);
            const auto number = number_in(text);
            if (!number) file.fail(fmt::format("'{}' is no coordinate", text));
            record.centre[axis] = *number;
        }
        record.element = element_of_pdb(*line);
        // Many programs leave these blank.
        record.put(occupancy, number_in(columns(*line, 55, 60)).value_or(1));
        record.put(b_factor, number_in(columns(*line, 61, 66)).value_or(0));
        builder.add(record);
    }
    if (frame > 0 && models <= frame) file.fail(fmt::format("it has {} models and no frame {}", models, frame));
}

}  // namespace matchlight
