// Controls of the scene file's settings, made from the table that also checks and documents them.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "preview/controls.h"
#include "preview/session.h"
#include "scene/scene_schema.h"

namespace matchlight {

/// A setting under its key, such as "object[1].material" and its roughness: it shows what holds and writes what is
/// changed. A setting that need not be given has a box beside it: unticked, it is left to the solve, or to its default.
void lay_out_setting(Session& session, Controls& controls, const Setting& setting, const std::string& section_key);

/// All settings of a section, and of those within it; `section_key` is the section's place in this scene.
void lay_out_section(Session& session, Controls& controls, std::string_view section, const std::string& section_key,
                     std::span<const std::string_view> left_out = {});

/// An effect: off, matched or by hand; and by hand its settings.
void lay_out_effect(Session& session, Controls& controls, const Setting& effect);

}  // namespace matchlight
