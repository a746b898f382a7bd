// From what a scene says of its footage to how it is opened.
#pragma once

#include <memory>

#include "core/warnings.h"
#include "media/frame_source.h"
#include "scene/scene_file.h"

namespace matchlight {

FootageOptions footage_options(const FootageSettings& footage, bool strict);

/// The scene's footage, or blank frames where it has a camera instead. Throws InputError.
std::unique_ptr<FrameSource> open_frames(const Scene& scene, bool strict, Warnings& warnings);

}  // namespace matchlight
