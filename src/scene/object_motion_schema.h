// The part of the scene file's table that says how an object moves: its `keys` and its `spin`.
#pragma once

#include <vector>

#include "scene/scene_schema.h"

namespace matchlight {

const std::vector<Setting>& object_motion_settings();

/// One more key of the last object, standing as the object does.
void begin_object_key(Scene& scene);

}  // namespace matchlight
