// What the solve rests on and its file does not keep: for whoever shows where it is weak.
#pragma once

#include <map>
#include <vector>

#include "core/transforms.h"
#include "tracking/camera_path.h"
#include "tracking/grey_card.h"
#include "tracking/photometry.h"
#include "tracking/rig_solve.h"

namespace matchlight {

struct TrackDetails {
    std::vector<FrameObservations> observations;  // of every frame that was decoded
    std::vector<PathFrame> path;                  // why the confidence of a frame is low
    std::vector<std::vector<CardReading>> cards;  // parallel to the observations
    std::map<int, CardExpectation> expected_cards;
    std::map<int, RigidTransform> world_from_tag;
};

}  // namespace matchlight
