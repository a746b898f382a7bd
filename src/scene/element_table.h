// The chemical elements as spheres: symbol, radius and colour.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace matchlight {

struct Element {
    std::string_view symbol;
    float radius_angstrom = 0;  // van der Waals
    std::uint32_t color = 0;    // 0xRRGGBB, sRGB-coded
};

/// By atomic number; 0 is what is not known.
const Element& element(int atomic_number);

/// The atomic number of a symbol in any case ("Fe", "FE"), of a label that begins with one ("Fe3+", "C12") or of a
/// number ("26"); 0 where it is none.
int atomic_number(std::string_view symbol);

}  // namespace matchlight
