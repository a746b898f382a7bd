// The part of the scene file's table that belongs to [effects].
#pragma once

#include <vector>

#include "scene/scene_schema.h"

namespace matchlight {

/// [effects] and the tables that effects set by hand take: `bloom = {threshold = 2}` is section "effects.bloom".
const std::vector<SceneSection>& effect_sections();
const std::vector<Setting>& effect_settings();

// Rows that have a file of their own.
void add_depth_of_field_settings(std::vector<Setting>& rows);
void add_motion_blur_settings(std::vector<Setting>& rows);
void add_sensor_settings(std::vector<Setting>& rows);
void add_color_transform_settings(std::vector<Setting>& rows);

}  // namespace matchlight
