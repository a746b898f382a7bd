// The solve of a scene: tracked footage's from its file, a virtual camera's from its settings.
#pragma once

#include "core/warnings.h"
#include "scene/scene_file.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// What is known of a virtual camera in every frame: everything, exactly. `scene` has a camera. Tags that the scene
/// gives a place keep it, so that objects may stand on them. Throws InputError naming the frame where the camera would
/// stand at the point it looks at.
Solve virtual_solve(const Scene& scene);

/// The solve that belongs to the scene, read and checked where it has footage. Throws InputError: there is none, or it
/// is of another scene.
Solve solve_of_scene(const Scene& scene, Warnings& warnings);

}  // namespace matchlight
