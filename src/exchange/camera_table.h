// The solve's numbers as CSV: a line a frame, for spreadsheets and scripts.
#pragma once

#include <string>

#include "exchange/camera_track.h"

namespace matchlight {

/// Place (m) and quaternion of the camera (x right, y down, z forward) in the z-up world, then what the solve says of
/// exposure, focus and shutter. A cell is empty where nothing is known. Tags are separated by spaces.
std::string camera_table_csv(const CameraTrack& track);

}  // namespace matchlight
