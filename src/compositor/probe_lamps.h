// The bright parts of a probe as directional lights, for shading that knows only lamps.
#pragma once

#include <vector>

#include "lighting/probe.h"
#include "scene/lamp.h"

namespace matchlight {

/// Its dominant lights (lighting/dominant_lights.h), each with its power as irradiance and its solid angle as a disc;
/// of a probe without any, one from where the most light comes, of what comes from there more than from the other side.
std::vector<LampSettings> lamps_of_probe(const Probe& probe);

}  // namespace matchlight
