// Reads one value of a scene file as its row in the schema says, or says what is wrong with it.
#pragma once

#include <filesystem>
#include <string>

#include <toml++/toml.h>

#include "core/warnings.h"
#include "scene/scene_schema.h"

namespace matchlight {

/// Where errors point to.
struct SceneSource {
    std::filesystem::path path;

    std::filesystem::path resolved(const std::string& written) const;
    /// Throws InputError naming the file and the line of `node` (no line where it has none).
    [[noreturn]] void fail(const toml::node& node, const std::string& cause, const std::string& cure = {}) const;
    [[noreturn]] void fail(const toml::key& key, const std::string& cause, const std::string& cure = {}) const;
};

/// The checked value of a kind that holds one (not section, sections, effect, left_out, not_built). Throws InputError:
/// another type, outside the range, not finite, a file that does not exist.
SettingValue read_setting(const SceneSource& source, const Setting& setting, const toml::node& node);

/// A value as one line of TOML.
std::string toml_text(const toml::node& node);

}  // namespace matchlight
