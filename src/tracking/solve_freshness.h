// Whether a solve still belongs to its scene: what was changed since `track` wrote it.
#pragma once

#include "core/warnings.h"
#include "scene/scene_file.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// Compares the settings recorded in `solve` with those of `scene`. Throws InputError, naming the solve file, when the
/// scene contradicts it: another size or place of a tag, another lens, another response, other colour settings of the
/// footage. Another light or another name of the footage is a warning: they may be tried on purpose. A solve that
/// records no settings of ours (from another program) is taken as it is.
void check_solve_is_of_scene(const Solve& solve, const Scene& scene, Warnings& warnings);

}  // namespace matchlight
