// What a photograph's light weighs in a merge, by the light that the merge predicts for it.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "calibration/code_table.h"
#include "calibration/exposure_pairs.h"

namespace matchlight {

/// Variance of one photograph's light, and the weight that follows, tabulated over the root of light, which spreads the
/// dark codes as noise does.
class MergeWeights {
public:
    /// `iso_gain`: of NoiseModel::variance.
    MergeWeights(const NoiseModel& noise, const CodeTable& table, const FullCodes& full, double iso_gain);

    /// Of the photograph's own light (code 1 = 1).
    float variance(float light, int channel) const { return rows_[index(light)].variance[at(channel)]; }
    /// 1/variance, fading to 0 where noise could carry the light to full code: samples that noise carried there are
    /// missing, and those left over would be too dark on average.
    float weight(float light, int channel) const { return rows_[index(light)].weight[at(channel)]; }
    /// The same, fading to 0 where the light drowns in noise: negative noise ends at code 0, and what is left over
    /// would be too bright.
    float weight_above_noise(float light, int channel) const {
        return rows_[index(light)].weight_above_noise[at(channel)];
    }
    float full_light(int channel) const { return full_light_[at(channel)]; }

private:
    static constexpr std::size_t steps = 1024;
    struct Row {
        std::array<float, 3> variance, weight, weight_above_noise;
    };

    static std::size_t at(int channel) { return static_cast<std::size_t>(channel); }
    std::size_t index(float light) const;

    std::array<float, 3> full_light_{};
    float scale_ = 1;  // of light to 0..1
    std::vector<Row> rows_;
};

}  // namespace matchlight
