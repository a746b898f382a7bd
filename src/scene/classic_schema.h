// Rows of the scene file's table for classic shading, among those of an object's material.
#pragma once

#include <vector>

#include "scene/scene_schema.h"

namespace matchlight {

const std::vector<Setting>& classic_settings();

}  // namespace matchlight
