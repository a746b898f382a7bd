// What the report says of making probes holds: what costs more is nearer to the truth, and what is left out changes
// nothing.
#include "report/probe_experiments.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

double flip_of(const Experiment& experiment, const std::string& level) {
    const auto candidate = std::ranges::find(
        experiment.candidates, level, [](const Candidate& one) -> const std::string& { return one.point.level; });
    if (candidate == experiment.candidates.end()) return std::nan("");
    return errors_of(experiment.reference, candidate->picture(), probe_codes).flip.value_or(std::nan(""));
}

TEST(ProbeExperiments, WhatCostsMoreIsNearerToTheTruth) {
    std::size_t made = 0;
    const std::vector<Experiment> experiments = probe_experiments([&made] { ++made; });
    ASSERT_EQ(experiments.size(), probe_experiment_count);
    EXPECT_EQ(made, probe_experiment_count);
    const Experiment &merge = experiments[0], &unwrap = experiments[1], &parallax = experiments[2],
                     &resample = experiments[3];
    for (const Experiment& experiment : experiments) {
        // The reference's own error is far below what it measures.
        const auto own = errors_of(experiment.reference, experiment.coarse_reference, probe_codes).flip;
        EXPECT_LT(*own, 0.3 * flip_of(experiment, experiment.candidates.front().point.level)) << experiment.report.name;
    }
    // Photographs that are a pixel off one another.
    EXPECT_LT(flip_of(merge, "final"), 0.8 * flip_of(merge, "plain"));
    // Finer samples change no more than a tenth: the ball's own pixels are what is seen.
    EXPECT_NEAR(flip_of(unwrap, "16 samples") / flip_of(unwrap, "final"), 1, 0.1);
    EXPECT_LT(flip_of(parallax, "full"), 0.9 * flip_of(parallax, "off"));
    EXPECT_EQ(parallax.left_out->code_difference(), 0);
    // All of the light arrives.
    for (const Candidate& candidate : resample.candidates) {
        if (candidate.point.level != "final") continue;
        EXPECT_NEAR(candidate.light() / resample.reference_light, 1, 1e-5);
    }
}

}  // namespace
}  // namespace matchlight
