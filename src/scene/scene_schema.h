// The table of all settings of a scene file: it drives reading, checking, defaults, error messages and documentation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "scene/scene_file.h"

namespace matchlight {

enum class SettingKind {
    boolean,
    integer,
    number,
    text,
    choice,      // one of a few words
    measure,     // a number, or one of a few words: then `text` is the word, otherwise empty
    color,       // [r, g, b], scene-linear
    vector,      // [x, y, z]
    interval,    // [from, to], ascending: the vector's x and y
    scale,       // a number for all axes, or [x, y, z]
    rotation,    // a number about z, or [x, y, z]
    input_file,  // must exist; or one of `choices`
    footage,     // a file that exists, or a numbered pattern
    any_file,    // need not exist yet
    section,     // a table of settings of its own: "material" of "object" is section "object.material"
    sections,    // an array of them
    effect,      // "off", "auto" (its section's defaults) or a table of its section
    left_out,    // known, but this version does without it and says so; "off" and false say nothing
    not_built,   // known, but this version cannot do it
};

/// What a setting may hold. `lowest` itself is excluded where `above_lowest`. Colours, vectors, scales and rotations
/// are held to the range component by component.
struct SettingDomain {
    SettingKind kind = SettingKind::boolean;
    double lowest = -std::numeric_limits<double>::infinity();
    double highest = std::numeric_limits<double>::infinity();
    bool above_lowest = false;
    std::vector<std::string_view> choices;
};

/// A checked value; the member that belongs to the setting's kind is set.
struct SettingValue {
    bool boolean = false;
    std::int64_t integer = 0;
    double number = 0;
    std::string text;
    std::size_t choice = 0;  // index into SettingDomain::choices
    Eigen::Vector3d vector = Eigen::Vector3d::Zero();
    std::filesystem::path path;  // relative ones resolved against the scene file's folder
};

/// Fallback of a setting that has none because it must be given.
inline constexpr std::string_view must_be_given = "(must be given)";

struct Setting {
    std::string_view section;
    std::string_view key;
    SettingDomain domain;
    std::string_view unit;
    std::string_view fallback;  // TOML text; empty: stays unset
    std::string_view help;
    void (*set)(Scene&, const SettingValue&);  // null for kinds that hold no value of their own; of an effect that is
                                               // on by itself: turns it off
};

enum class SectionUse {
    always,    // its defaults hold even when the file has no such section
    optional,  // absent unless the file has it
    repeated,  // [[section]]
    nested,    // the value of a setting of another section
};

struct SceneSection {
    std::string_view name;
    SectionUse use;
    std::string_view help;
    void (*begin)(Scene&);  // makes the place that the section's settings are written to; may be null
};

std::span<const SceneSection> scene_sections();
std::span<const Setting> scene_settings();

const SceneSection* find_section(std::string_view name);
const Setting* find_setting(std::string_view section, std::string_view key);

/// A section's name as a file has it: without what tells one form of its entries from another.
std::string_view written_section(std::string_view name);

/// What a value of the domain looks like: "number, from 0 to 1".
std::string describe(const SettingDomain& domain);

/// The known word that is fewest edits (insertion, deletion, replacement, swap of neighbours) away from `word`.
std::string_view nearest_word(std::string_view word, std::span<const std::string_view> known);

}  // namespace matchlight
