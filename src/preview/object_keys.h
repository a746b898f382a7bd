// Objects that move by keys: how they stand at a frame, and what a hand makes of that.
#pragma once

#include <cstdint>
#include <string>

#include "preview/handles.h"
#include "scene/scene_edit.h"

namespace matchlight {

/// As its keys have it at that frame; without keys, as it is placed at all of them. What it spins by is not in it.
Placing placing_at(const ObjectSettings& object, std::int64_t frame);

/// Gives `object`, which `text` has under `object_key` ("object[1]"), that placing at that frame: in the key that is
/// there, or in a new one. Without keys, at all frames. `grip`: what of it has changed. Throws InputError.
void set_placing(SceneText& text, const std::string& object_key, const ObjectSettings& object, std::int64_t frame,
                 Grip grip, const Placing& placing);

}  // namespace matchlight
