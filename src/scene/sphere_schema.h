// The part of the scene file's table that says how a file's columns become spheres: `object.sphere`.
#pragma once

#include <vector>

#include "scene/scene_schema.h"

namespace matchlight {

const std::vector<Setting>& sphere_settings();

}  // namespace matchlight
