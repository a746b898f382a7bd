// Tables of variance and weight.
#include "calibration/merge_weights.h"

#include <algorithm>
#include <cmath>

namespace matchlight {
namespace {

/// 0 at one deviation from an end of the codes, 1 from three: a sample beyond is one in a thousand.
double fading(double deviations) {
    const double t = std::clamp((deviations - 1) / 2, 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

}  // namespace

MergeWeights::MergeWeights(const NoiseModel& noise, const CodeTable& table, const FullCodes& full, double iso_gain) {
    for (int channel = 0; channel < 3; ++channel) full_light_[at(channel)] = table.light(full[at(channel)], channel);
    scale_ = 1 / *std::max_element(full_light_.begin(), full_light_.end());
    rows_.resize(steps + 1);
    for (std::size_t i = 0; i <= steps; ++i) {
        const double root = static_cast<double>(i) / steps;
        const double light = root * root / scale_;
        for (int channel = 0; channel < 3; ++channel) {
            const double rounding =
                table.slope(table.code(static_cast<float>(light), channel), channel) * table.code_step();
            // A model without noise and a curve that is flat at its ends would weigh a sample infinitely.
            const double least = 1e-12 / (scale_ * scale_);
            const double variance = std::max(noise.variance(light, iso_gain, rounding), least);
            const double sigma = std::sqrt(variance);
            const double below_full = fading((full_light_[at(channel)] - light) / sigma);
            rows_[i].variance[at(channel)] = static_cast<float>(variance);
            rows_[i].weight[at(channel)] = static_cast<float>(below_full / variance);
            rows_[i].weight_above_noise[at(channel)] =
                static_cast<float>(below_full * fading(light / sigma) / variance);
        }
    }
}

std::size_t MergeWeights::index(float light) const {
    const float root = std::sqrt(std::clamp(light * scale_, 0.0f, 1.0f));
    return static_cast<std::size_t>(std::lround(root * steps));
}

}  // namespace matchlight
