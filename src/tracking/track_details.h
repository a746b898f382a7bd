// What the solve rests on and its file does not keep: for whoever shows where it is weak.
#pragma once

#include <vector>

#include "tracking/camera_path.h"
#include "tracking/rig_solve.h"

namespace matchlight {

struct TrackDetails {
    std::vector<FrameObservations> observations;  // of every frame that was decoded
    std::vector<PathFrame> path;                  // why the confidence of a frame is low
};

}  // namespace matchlight
