// Rows of the scene file's table for analytic lights.
#pragma once

#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include "scene/scene_schema.h"
#include "scene/setting_reader.h"

namespace matchlight {

/// The section of each entry of [[light]] that has a type.
inline constexpr std::string_view lamp_section = "light[]";

const std::vector<Setting>& lamp_settings();

/// What only several settings together tell. Throws InputError.
void check_lamp(const SceneSource& source, const LampSettings& lamp, const toml::table& table);

}  // namespace matchlight
