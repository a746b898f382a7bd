// Options that say how the columns of a file become spheres, as `[object.sphere]` does in a scene.
#pragma once

#include <CLI/App.hpp>

#include "scene/scene_file.h"

namespace matchlight {

void add_sphere_options(CLI::App& command, SphereSettings& settings);

}  // namespace matchlight
