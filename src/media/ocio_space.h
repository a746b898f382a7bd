// A camera's colour space by its name in an OpenColorIO config, taken apart into a curve a channel and primaries.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/primaries.h"

namespace matchlight {

/// light of Rec.709 = rec709_from(primaries) · curve(code), channel by channel: what cameras' log and gamma spaces are.
/// Grey codes make grey light, and the code 1 in every channel makes the light 1: exposure is relative, as it is with
/// any response.
struct OcioSpace {
    std::vector<double> codes;                  // 0 to 1, even
    std::array<std::vector<double>, 3> linear;  // at each code, strictly increasing
    Primaries primaries;
};

/// Reads `config`, or the one that $OCIO names where it is empty. Its scene-linear light is known by its role
/// aces_interchange or, without it, by a space of a name that is usual for ACES2065-1 or linear Rec.709. Throws
/// InputError: no config, a space that it does not have, one whose conversion is no curve and matrix (tables in three
/// dimensions, changes of saturation) within a thousandth, or is not monotone.
OcioSpace ocio_space(const std::filesystem::path& config, const std::string& space);

}  // namespace matchlight
