// Measures once what every level costs on this machine, for scenes with a budget.
#pragma once

#include <functional>

#include "compositor/level_table.h"
#include "core/warnings.h"
#include "gl/context.h"
#include "report/run_time.h"

namespace matchlight {

/// Whole frames of a made-up scene in a room with lamps, with the object small and large, at every level of every part:
/// what grows with the pixels and what does not. Errors are FLIP against the level `reference`. `done` is called after
/// every measured part.
LevelTable calibrate_machine(GlContext& context, const TimingOptions& timing, const std::function<void()>& done);
/// How often `done` is called.
int calibration_steps();

}  // namespace matchlight
