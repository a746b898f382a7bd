// Colour maps: a number from 0 to 1 as a colour.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace matchlight {

/// Their names, as `color_map` of a scene takes them.
const std::vector<std::string_view>& color_map_names();

/// 256 colours, sRGB-coded, from the map's beginning to its end. `map` indexes color_map_names().
std::vector<std::array<std::uint8_t, 4>> color_map_table(std::size_t map);

}  // namespace matchlight
