// Two compositors of one frame.
#include "report/frame_trial.h"

namespace matchlight {

LeftOutTrial whole_frame_trial(const SceneStage& stage, const std::string& condition,
                               const std::shared_ptr<Compositor>& drawn, const std::shared_ptr<Compositor>& skipped) {
    return {.condition = condition,
            .drawn = [&stage, drawn] { drawn->composite(*stage.plate); },
            .skipped = [&stage, skipped] { skipped->composite(*stage.plate); },
            .code_difference =
                [&stage, drawn, skipped] {
                    return largest_code_difference(drawn->composite(*stage.plate).rgb8(),
                                                   skipped->composite(*stage.plate).rgb8());
                }};
}

}  // namespace matchlight
