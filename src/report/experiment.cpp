// Runs the candidates of one effect.
#include "report/experiment.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>

#include "gl/bandwidth.h"
#include "report/flip.h"
#include "report/flip_colors.h"
#include "report/hdr_flip.h"
#include "report/image_error.h"

namespace matchlight {
namespace {

/// Light below 0 (which a sum of signed effects may round to) shows as 0; what is not finite shows as the most there
/// is.
ImageF repaired(const ImageF& light) {
    ImageF clean = light;
    for (float& value : clean.samples()) {
        constexpr float most = 1e30F;
        value = std::isnan(value) ? most : std::clamp(value, 0.0F, most);
    }
    return clean;
}

}  // namespace

PointErrors errors_of(const ImageF& reference, const ImageF& test, const CodeOfLight& code_of) {
    if (reference.empty()) return {};
    const ImageF expected = repaired(reference), found = repaired(test);
    const Image8 expected_code = code_of(expected), found_code = code_of(found);
    return {masked_mean(flip_error_map(expected_code, found_code)), masked_mean(hdr_flip_error_map(expected, found)),
            psnr_db(expected_code, found_code), relative_rms(expected, found)};
}

int largest_code_difference(const Image8& a, const Image8& b) {
    assert(a.bounds() == b.bounds() && a.channels() == b.channels());
    int largest = 0;
    for (std::size_t i = 0; i < a.samples().size(); ++i) {
        largest = std::max(largest, std::abs(a.samples()[i] - b.samples()[i]));
    }
    return largest;
}

EffectReport run_experiment(const Experiment& experiment, const CodeOfLight& code_of, const TimingOptions& timing) {
    EffectReport report = experiment.report;
    const bool has_reference = !experiment.reference.empty();
    if (has_reference) report.reference_picture = code_of(repaired(experiment.reference));
    if (!experiment.coarse_reference.empty()) {
        report.reference_self_error_flip = errors_of(experiment.reference, experiment.coarse_reference, code_of).flip;
    }
    std::vector<std::function<void()>> works;
    for (const Candidate& candidate : experiment.candidates) {
        EffectPoint& point = report.points.emplace_back(candidate.point);
        works.push_back(candidate.work);
        if (!has_reference) continue;
        const ImageF picture = candidate.picture();
        if (candidate.bytes) point.bytes = candidate.bytes();
        point.errors = errors_of(experiment.reference, picture, code_of);
        if (candidate.light && experiment.reference_light > 0) {
            point.errors.mean_light = candidate.light() / experiment.reference_light - 1;
            point.knobs.push_back({"light_kept", candidate.light() / experiment.input_light});
        }
        point.picture = code_of(repaired(picture));
        point.flip_map = flip_colors(flip_error_map(report.reference_picture, point.picture));
    }
    if (experiment.left_out) {
        works.push_back(experiment.left_out->drawn);
        works.push_back(experiment.left_out->skipped);
    }
    const std::vector<RunTime> times = time_in_turn(works, experiment.stopwatch, timing);
    for (std::size_t i = 0; i < report.points.size(); ++i) {
        EffectPoint& point = report.points[i];
        point.time = times[i];
        if (point.bytes > 0) point.bandwidth_bounds = times[i].median_ms * 1e-3 * copy_bytes_per_second() / point.bytes;
    }
    if (const auto& trial = experiment.left_out) {
        report.left_out = LeftOutRow{trial->condition, times[times.size() - 2].median_ms - times.back().median_ms,
                                     trial->code_difference(), trial->cost};
    }
    return report;
}

}  // namespace matchlight
