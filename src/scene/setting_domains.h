// Short forms of what a setting may hold, for the rows of the scene file's table.
#pragma once

#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/scene_schema.h"

namespace matchlight {

inline SettingDomain of_kind(SettingKind kind) {
    return {.kind = kind, .choices = {}};
}
inline SettingDomain between(SettingKind kind, double lowest, double highest) {
    return {.kind = kind, .lowest = lowest, .highest = highest, .choices = {}};
}
/// `lowest` itself is excluded.
inline SettingDomain above(SettingKind kind, double lowest, double highest) {
    return {.kind = kind, .lowest = lowest, .highest = highest, .above_lowest = true, .choices = {}};
}
inline SettingDomain one_of(std::vector<std::string_view> choices) {
    return {.kind = SettingKind::choice, .choices = std::move(choices)};
}

/// A file that must exist, or one of a few words.
inline SettingDomain input_file_or(std::vector<std::string_view> words) {
    return {.kind = SettingKind::input_file, .choices = std::move(words)};
}

inline std::array<double, 3> color_of(const SettingValue& value) {
    return {value.vector.x(), value.vector.y(), value.vector.z()};
}

}  // namespace matchlight
