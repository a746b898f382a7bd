// Rows of the scene file's table for relief, patterns and layers of pictures.
#pragma once

#include <vector>

#include "scene/scene_schema.h"

namespace matchlight {

const std::vector<SceneSection>& surface_detail_sections();
const std::vector<Setting>& surface_detail_settings();

}  // namespace matchlight
