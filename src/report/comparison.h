// Two pictures compared by every measure, over the whole frame and over the two sides of a mask.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/image.h"
#include "report/flip.h"

namespace matchlight {

/// The measures over some of a frame's pixels; absent where none are counted, or the picture is too small for the
/// measure.
struct ErrorMeasures {
    std::optional<double> flip;  // mean error, 0..1
    std::optional<double> psnr_db;
    std::optional<double> ssim;
    std::optional<double> relative_rms;  // of linear light, where both pictures hold it
};

struct FrameComparison {
    std::int64_t frame = 0;
    ErrorMeasures whole;
    std::optional<double> mask_share;  // present with a mask, as are the next two
    ErrorMeasures inside;
    ErrorMeasures outside;
    /// With a plate: the test against the plate outside the region, where nothing may change.
    std::optional<double> outside_plate_psnr_db;
};

struct ComparedPair {
    const Image8& reference;
    const Image8& test;
    const ImageF* reference_linear = nullptr;
    const ImageF* test_linear = nullptr;
    const Image8* mask = nullptr;
    const Image8* plate = nullptr;
};

/// All pictures must be of one size. `flip_map`, where given, receives the error map.
FrameComparison compare_pictures(const ComparedPair& pair, const FlipOptions& options, ImageF* flip_map = nullptr);

/// The mean of each measure over the frames that have it.
FrameComparison mean_comparison(const std::vector<FrameComparison>& frames);

}  // namespace matchlight
