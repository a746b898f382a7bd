// An animated camera with its optics, and the rig's tags, as USD's own text (.usda).
#pragma once

#include <string>

#include "exchange/camera_track.h"

namespace matchlight {

/// z-up like Matchlight's world, in centimetres, so that USD's "tenths of a unit" of focal length and aperture are the
/// millimetres that most programs take them for. The principal point is held by the aperture's offsets, fx ≠ fy by
/// its two sizes. Where the solve knows them: focusDistance, fStop, shutter:open and shutter:close (about
/// mid-exposure, where the pose is), exposure, and white balance as a custom attribute. Where a frame has no pose
/// the camera stays where it was and is invisible.
std::string usd_camera_text(const CameraTrack& track);

}  // namespace matchlight
