// The upper median: the element in the middle, or of two in the middle the greater one.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <span>
#include <vector>

namespace matchlight {

/// Reorders `values`, of which there is at least one.
inline double upper_median_in_place(std::span<double> values) {
    assert(!values.empty());
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

inline double upper_median(std::vector<double> values) {
    return upper_median_in_place(values);
}

}  // namespace matchlight
