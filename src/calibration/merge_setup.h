// What the steps of a merge share: photographs as light, what each weighs, and where each is full.
#pragma once

#include <vector>

#include "calibration/code_table.h"
#include "calibration/exposure_series.h"
#include "calibration/merge_weights.h"
#include "core/image.h"

namespace matchlight {

struct MergeSetup {
    const CodeTable& table;
    const NoiseModel& noise;
    const FullCodes& full;
    std::vector<const ImageF*> codes;   // of the photographs, the longest exposure first, on one grid of pixels
    std::vector<double> exposures;      // likewise
    std::vector<MergeWeights> weights;  // likewise

    int width() const { return codes.front()->width(); }
    int height() const { return codes.front()->height(); }
    /// Half a code's step below: codes between those of the file come from resampling.
    bool clipped(float code, int channel) const {
        return code > full[static_cast<std::size_t>(channel)] - 0.5 * table.code_step();
    }
    bool clipped(std::size_t shot, int x, int y) const {
        const float* code = codes[shot]->pixel(x, y);
        return clipped(code[0], 0) || clipped(code[1], 1) || clipped(code[2], 2);
    }
};

/// The photograph that exposes most pixels well: clipped in no channel, green not dark and above its noise.
std::size_t best_exposed(const MergeSetup& setup);

/// For each photograph, 255 where it disagrees with the reference beyond noise, over whole regions. Where the reference
/// is clipped the next shorter exposure speaks for it, where it is drowned in noise the next longer one.
std::vector<Image8> ghost_masks(const MergeSetup& setup, std::size_t reference);

}  // namespace matchlight
