// A setting held to its range.
#pragma once

#include <stdexcept>

#include <fmt/format.h>

namespace matchlight {

/// Throws std::invalid_argument; NaN lies in no range.
inline void check_range(const char* name, double value, double lowest, double highest) {
    if (value >= lowest && value <= highest) return;
    throw std::invalid_argument(fmt::format("{} is {}, not from {} to {}", name, value, lowest, highest));
}

}  // namespace matchlight
