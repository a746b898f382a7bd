// The hand at the camera: leaves the footage, flies around the scene, comes back.
#pragma once

#include "preview/canvas.h"
#include "preview/session.h"

namespace matchlight {

/// From where the footage's camera stands, about what it has in its middle; or back to it.
void toggle_flight(Session& session);
/// Behind canvas and hand in every frame: left button turns unless the hand holds something, right or middle button
/// shifts, the wheel goes nearer.
void lay_out_flight(const Region& area, const Canvas& canvas, bool hand_holds, Session& session);

}  // namespace matchlight
