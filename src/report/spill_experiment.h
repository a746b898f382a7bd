// Experiments on effects that spill the frame's bright light: the scene's own frame is what they act on.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "report/bright_reference.h"
#include "report/effect_stage.h"
#include "report/experiments.h"

namespace matchlight {

/// One way to compute the effect.
struct SpillWay {
    std::string label;
    std::vector<Knob> knobs;
    std::string precision = "16F";
    AddEffect add;
};

struct SpillExperiment {
    std::string name, what, reference_words;
    std::vector<SpillWay> ways;
    std::size_t final_way = 0;  // whose leaving out is measured
    /// Light below it spills nothing by the effect's definition.
    double dark_below = 0;
    /// What the effect adds to the whole frame, in double precision, with all the effort or half of it (empty where
    /// there is nothing to halve).
    std::function<ImageD(const FrameLightImages& light, bool with_half)> reference;
};

/// The frame's light without any camera effect.
FrameLightImages frame_light_of(const SceneStage& stage);
/// The whole frame's light, RGB: the plate, and within the light's region what the objects leave of it.
ImageF frame_picture(const SceneStage& stage, const FrameLightImages& light);
/// Light over a part of the frame put into the dark whole.
FrameLightImages over_whole_frame(const FrameLightImages& light);

/// Says that the frame leaves the effect out where it finds nothing to do.
Experiment make_experiment(const SceneStage& stage, const SpillExperiment& spill);

}  // namespace matchlight
