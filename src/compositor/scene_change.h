// What a changed scene needs made anew of what a compositor holds.
#pragma once

#include "scene/scene_file.h"

namespace matchlight {

struct SceneChange {
    bool all = false;         // footage, camera, tags, files, quality: nothing can stay as it is
    bool placement = false;   // where objects stand, or on what
    bool materials = false;   // their factors
    bool reflection = false;  // the form in which objects reflect the probe
    bool casting = false;     // which objects cast
    bool light = false;       // how the probe is turned and exposed, or where it was taken
    bool brightness = false;  // that is all of it: the probe is otherwise exposed, and there are no other lights
    bool surface = false;
    bool background = false;
    bool surface_picture = false;  // what the clip shows of the surface (compositor/surface_picture.h)

    /// Whether shadows fall otherwise, wherever objects stand.
    bool shadows() const { return casting || light || surface; }
    bool operator==(const SceneChange&) const = default;
};

/// Effects, names and what objects are focused as cost nothing to change and are not told.
SceneChange change_between(const Scene& before, const Scene& after);
/// Whether the two differ in nothing but in bloom and glare (what spills of the light): objects look the same before
/// it.
bool differ_in_spill_alone(const Scene& before, const Scene& after);

}  // namespace matchlight
