// Finds the places of tags that the scene does not give, from frames that show several of them.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "scene/scene_file.h"
#include "tracking/camera_pose.h"
#include "tracking/tag_fit.h"

namespace matchlight {

/// The tags seen in one frame.
struct FrameObservations {
    std::int64_t frame = 0;
    double time_s = 0;
    std::vector<TagObservation> tags;  // by id; an id may be seen twice
};

struct RigSolution {
    std::map<int, RigidTransform> world_from_tag;  // of every tag that has a place
    std::optional<int> origin;                     // the tag that is the world where no place is given
    std::vector<int> unplaced;                     // seen, but never together with a tag that has a place
    double rms = 0;  // of whitened residuals in the bundle adjustment; about 1 when all is consistent
};

/// Given places are held. Where none is given, the lowest id that was seen is the origin. The others come from relative
/// poses that agree over many frames, along the best-supported tree, then from a bundle adjustment (Ceres) of poses and
/// places with a robust loss. Deterministic.
RigSolution solve_rig(const std::vector<RigTag>& rig, const std::vector<FrameObservations>& frames);

}  // namespace matchlight
