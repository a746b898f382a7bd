// The meter pass: exposure control looks at the whole clip once, and keeps what it found beside the scene.
//
// Adaptation needs the past of every frame. Kept in a file, it leaves each frame a function of its number: chunks,
// single frames and the whole clip come out with the same bits.
#pragma once

#include <filesystem>

#include "core/warnings.h"
#include "gl/context.h"
#include "scene/scene_file.h"
#include "tracking/solve_file.h"

namespace matchlight {

struct MeterPassOptions {
    bool strict = false;  // as in FootageOptions
    bool quiet = false;   // no progress
};

/// Whether the scene asks for an exposure of its own instead of the footage's.
bool exposure_is_simulated(const Scene& scene);

/// "<scene>.meter.json" beside the scene.
std::filesystem::path meter_file_of(const Scene& scene);

/// Gives every frame of `solve` its simulated exposure where the scene asks for one: from the meter file, where that
/// was made from the same scene, solve, models, pictures and version; else by drawing the whole clip at a small size
/// first (footage at its own size), and writing the file. A folder that cannot be written is a warning. `context` must
/// be current. Throws InputError.
void meter_clip(Solve& solve, const Scene& scene, GlContext& context, const MeterPassOptions& options,
                Warnings& warnings);

}  // namespace matchlight
