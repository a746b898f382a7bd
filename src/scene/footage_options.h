// From what a scene says of its footage to how it is opened.
#pragma once

#include "media/frame_source.h"
#include "scene/scene_file.h"

namespace matchlight {

FootageOptions footage_options(const FootageSettings& footage, bool strict);

}  // namespace matchlight
