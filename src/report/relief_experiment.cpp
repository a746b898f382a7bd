// Ways to show a carved surface, by the steps of their search, against the same surface truly displaced.
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "report/experiments.h"
#include "report/relief_trial.h"

namespace matchlight {

namespace {

struct ReliefChoice {
    const char* name;
    ReliefMethod method;
    std::vector<int> steps;  // 0: flat
};

}  // namespace

std::optional<Experiment> relief_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    if (options.quick && !options.by_name) return std::nullopt;
    const auto trial = std::make_shared<ReliefTrial>(stage.shaders, stage.probe);
    Experiment experiment;
    EffectReport& report = experiment.report;
    report.name = "relief";
    report.what = fmt::format(
        "A square of {} m with stones {} m high under the scene's probe, seen from 50 degrees above it, by each way to "
        "show heights; flat: without them, what of the time is not the relief's.",
        ReliefTrial::square_m, ReliefTrial::carved_m);
    report.region = {0, 0, ReliefTrial::width, ReliefTrial::height};
    report.reference = "the square cut at every texel and displaced in double precision, drawn the same way";
    experiment.reference = trial->picture(*trial->displaced());
    const std::vector<ReliefChoice> choices = {{"flat", ReliefMethod::bump, {0}},
                                               {"bump", ReliefMethod::bump, {1}},
                                               {"parallax", ReliefMethod::parallax, {1}},
                                               {"occlusion", ReliefMethod::occlusion, {8, 16, 32, 64}},
                                               {"relief", ReliefMethod::relief, {8, 16, 32, 64, 128}},
                                               {"cone_step", ReliefMethod::cone_step, {4, 8, 16, 32}},
                                               {"sphere_tracing", ReliefMethod::sphere_tracing, {8, 16, 32}}};
    for (const ReliefChoice& choice : choices) {
        for (const int steps : choice.steps) {
            const auto renderer = trial->renderer(choice.method, steps);
            Candidate candidate;
            candidate.point = {
                .level = choice.steps.size() > 1 ? fmt::format("{} {}", choice.name, steps) : choice.name,
                .knobs = {{"relief_steps", static_cast<double>(steps)}},
                .precision = "32F"};
            candidate.work = [trial, renderer] { trial->draw(*renderer); };
            candidate.picture = [trial, renderer] { return trial->picture(*renderer); };
            experiment.candidates.push_back(std::move(candidate));
        }
    }
    return experiment;
}

}  // namespace matchlight
