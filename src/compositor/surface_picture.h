// The picture of the real surface: what its plane sends out, gathered once from frames all over the clip.
//
// A mirror on a table shows the table. The probe knows it from one place and coarsely; the footage itself knows it
// finely wherever it saw it, in one frame or another.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "core/warnings.h"
#include "render/gathered_surface.h"
#include "scene/scene_file.h"
#include "tracking/solve_file.h"

namespace matchlight {

struct SurfacePictureOptions {
    bool needed = true;      // false: nothing is read, and there is none
    bool strict = false;     // as in FootageOptions
    bool quiet = false;      // no progress
    int most_frames = 24;    // spread evenly over the clip
    int most_texels = 2048;  // along a side
};

/// Radiance of the plane z = [surface] z in the light's own units: plate-linear light without exposure, white balance
/// and vignette. Frames are weighed by how finely and sharply they see a texel and by their noise; what passes over the
/// surface in the fewer of them is left out, so is what the scene's holdouts hide, and where they disagree the texel is
/// unknown. nullopt: the scene has no footage or no surface, or no frame with a pose sees it. A function of scene,
/// solve and footage alone. Throws InputError.
std::optional<GatheredSurface> gather_surface(const Scene& scene, const Solve& solve,
                                              const SurfacePictureOptions& options, Warnings& warnings);

/// "<scene>.surface.exr" beside the scene.
std::filesystem::path surface_picture_file_of(const Scene& scene);

/// The same from its file, where that was made from the same surface, solve and footage by this version; else gathered
/// and written there. A folder that cannot be written is a warning. Null: there is none, or nothing would look at it.
std::shared_ptr<const GatheredSurface> surface_picture_of_clip(const Scene& scene, const Solve& solve,
                                                               const SurfacePictureOptions& options,
                                                               Warnings& warnings);

}  // namespace matchlight
