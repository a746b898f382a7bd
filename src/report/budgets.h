// What budgets choose for a scene's frame, predicted beside measured.
#pragma once

#include <vector>

#include "report/run_time.h"
#include "report/scene_stage.h"

namespace matchlight {

/// The scene's own budget, and half, one and two times what a frame at level final takes. Empty where there is no table
/// of this machine.
std::vector<BudgetRow> budgets_predicted_and_measured(const SceneStage& stage, const TimingOptions& timing);

}  // namespace matchlight
