// The whole frame at each quality level, against a picture of how the scene really looked.
#pragma once

#include <vector>

#include "report/experiments.h"

namespace matchlight {

/// FLIP inside the region that the objects change (report/change_region.h), and what a frame costs. `truth` is of the
/// plate's size.
std::vector<TruthRow> frame_error_against_truth(const SceneStage& stage, const Image8& truth,
                                                const ExperimentOptions& options, const TimingOptions& timing);

}  // namespace matchlight
