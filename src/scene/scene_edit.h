// A scene file's text, changed key by key: comments, order, blank lines and line ends stay as they are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/warnings.h"
#include "scene/scene_file.h"

namespace matchlight {

/// A scene file is text a person writes; this is thousands of objects.
inline constexpr std::size_t scene_limit_bytes = 16u << 20;

/// What a file says where a table of more than numbers is meant: "[{frame = 0, translate = [0, 0, 0.1]}]".
struct TomlText {
    explicit TomlText(std::string toml) : text(std::move(toml)) {}
    std::string text;
};

using SceneValue = std::variant<bool, std::int64_t, double, std::string, std::vector<double>, TomlText>;
using SceneEntries = std::vector<std::pair<std::string, SceneValue>>;

/// Keys are written as "effects.bloom.strength" and "object[1].material.roughness", elements counted from 0.
class SceneText {
public:
    /// `path` is where the text is from or goes: what is in it is relative to that. Throws InputError where it is no
    /// TOML.
    SceneText(std::filesystem::path path, std::string text);
    /// Throws InputError.
    static SceneText load(const std::filesystem::path& path);

    const std::filesystem::path& path() const { return path_; }
    const std::string& text() const { return text_; }

    bool has(std::string_view key) const;
    /// Of a list; 0 where there is none.
    std::size_t count(std::string_view key) const;

    // Each change is held against what the parser reads of the text before and after: it has changed that key and no
    // other, or throws InputError, with the line, and has changed nothing. What the scene may hold is load_scene()'s to
    // say.

    /// Gives a key a value; tables that it needs are added. A word in the place of a table ("auto", "off") gives way to
    /// a table.
    void set(std::string_view key, const SceneValue& value);
    /// Removes a key, a table with all that is in it, or an element of a list. Not being there is no error.
    void remove(std::string_view key);
    /// Adds an element to a list of tables: append("object", {{"shape", "sphere"}}).
    void append(std::string_view list, const SceneEntries& entries);

private:
    std::filesystem::path path_;
    std::string text_;
};

/// A value as a scene file has it: numbers as few digits as bring them back. Throws InputError where it is not finite.
std::string scene_value_text(const SceneValue& value);

/// The scene that the text would be as its file.
Scene load_scene(const SceneText& text, Warnings& warnings);

}  // namespace matchlight
