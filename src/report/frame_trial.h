// What leaving an effect out saves, measured on whole frames.
#pragma once

#include <memory>
#include <string>

#include "report/experiment.h"
#include "report/scene_stage.h"

namespace matchlight {

/// `drawn` makes the effect where it does nothing, `skipped` does without; both of the stage's frame.
LeftOutTrial whole_frame_trial(const SceneStage& stage, const std::string& condition,
                               const std::shared_ptr<Compositor>& drawn, const std::shared_ptr<Compositor>& skipped);

}  // namespace matchlight
