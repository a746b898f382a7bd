// Keys of a scene file by their names, in what the parser read of it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include "scene/toml_places.h"

namespace matchlight {

/// "object[1]": a name, and which element of the list.
struct SceneKeyStep {
    std::string name;
    std::optional<std::size_t> index = {};
};

/// Of "object[1].material.roughness": names are letters, digits and '_'.
std::vector<SceneKeyStep> scene_key_steps(std::string_view key);

/// Where a key is, or where it would be. Where no index is given a list of one table stands for the table, and
/// [[light]] for its entry that has a probe.
struct PlaceOfKey {
    const toml::node* node =
        nullptr;                     // the value; or, where names are missing, a word in the place of a table; or null
    const toml::key* key = nullptr;  // of the value
    const toml::array* list = nullptr;       // that the value is an element of
    std::size_t index = 0;                   // in it
    const toml::table* parent = nullptr;     // that has the key, or the innermost that there is
    const toml::table* container = nullptr;  // whose header or braces the parent is written under: itself, unless it
    std::vector<std::string> prefix;         // is dotted, by these names
    std::vector<std::string> names;          // of the container, from the root
    std::vector<std::string> missing;        // of the key, below the parent, or the word
};

/// Throws InputError where an element is not there.
PlaceOfKey place_of_key(const TomlPlaces& places, std::span<const SceneKeyStep> steps,
                        const std::filesystem::path& path);
/// Null where it is not there.
const toml::node* node_of_key(const toml::table& root, std::span<const SceneKeyStep> steps);

// What a change of the text is to change of what is read. `value` is TOML. Throw InputError where it is none, or where
// the key is an element of a list.
void set_in_tree(toml::table& root, std::span<const SceneKeyStep> steps, const std::string& value,
                 const std::filesystem::path& path);
/// The key is there.
void remove_from_tree(toml::table& root, std::span<const SceneKeyStep> steps);
void append_in_tree(toml::table& root, std::span<const SceneKeyStep> steps, const std::string& value,
                    const std::filesystem::path& path);

}  // namespace matchlight
