// The part of the scene file's table that belongs to scenes without footage: [camera] and [background].
#pragma once

#include <vector>

#include "scene/scene_schema.h"

namespace matchlight {

const std::vector<SceneSection>& camera_sections();
const std::vector<Setting>& camera_settings();

}  // namespace matchlight
