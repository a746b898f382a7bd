// One effect computed in several ways, each held against a reference and timed.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "report/report.h"
#include "report/run_time.h"

namespace matchlight {

struct Candidate {
    EffectPoint point;                // its level, knobs and precision
    std::function<void()> work;       // what is timed; empty: it takes no time
    std::function<ImageF()> picture;  // linear light, RGB, over the experiment's region
    std::function<double()> bytes;    // moved, known after picture(); empty where it is not
    std::function<double()> light;    // mean of what an effect spreads and must keep, known after picture()
};

/// How skipping the effect is measured.
struct LeftOutTrial {
    std::string condition;
    std::function<void()> drawn;    // the effect, where nothing needs it
    std::function<void()> skipped;  // what remains to be done
    /// Largest difference of 8-bit codes between the effect drawn and left out, where the condition holds.
    std::function<int()> code_difference;
    std::vector<Knob> cost = {};  // what the condition costs
};

struct Experiment {
    EffectReport report;  // all but points and errors
    Stopwatch stopwatch = Stopwatch::gpu;
    std::vector<Candidate> candidates;
    ImageF reference, coarse_reference;  // the latter with half the effort; may be empty
    double reference_light = 0;          // mean, where candidates have `light`
    double input_light = 0;              // mean of what is spread, before it is
    std::optional<LeftOutTrial> left_out;
};

/// From linear light to what a display is sent.
using CodeOfLight = std::function<Image8(const ImageF&)>;

/// Errors and pictures first, then the times, all in turn.
EffectReport run_experiment(const Experiment& experiment, const CodeOfLight& code_of, const TimingOptions& timing);

/// FLIP of what a display shows, HDR-FLIP, PSNR and relative RMS of the light. Empty images have no errors.
PointErrors errors_of(const ImageF& reference, const ImageF& test, const CodeOfLight& code_of);

/// Of two pictures of one size.
int largest_code_difference(const Image8& a, const Image8& b);

}  // namespace matchlight
