// Joins the measures of flip.h, image_error.h and ssim.h.
#include "report/comparison.h"

#include <utility>

#include "report/image_error.h"
#include "report/ssim.h"

namespace matchlight {
namespace {

ErrorMeasures measure(const ComparedPair& pair, const ImageF& flip_map, const Image8* mask) {
    ErrorMeasures measures;
    measures.flip = masked_mean(flip_map, mask);
    measures.psnr_db = psnr_db(pair.reference, pair.test, mask);
    measures.ssim = ssim(pair.reference, pair.test, mask);
    if (pair.reference_linear != nullptr && pair.test_linear != nullptr) {
        measures.relative_rms = relative_rms(*pair.reference_linear, *pair.test_linear, mask);
    }
    return measures;
}

/// Sums one measure over the frames; `value_of` picks it.
template <class Pick>
std::optional<double> mean_of(const std::vector<FrameComparison>& frames, Pick value_of) {
    double sum = 0;
    int count = 0;
    for (const FrameComparison& frame : frames) {
        if (const std::optional<double> value = value_of(frame)) {
            sum += *value;
            ++count;
        }
    }
    if (count == 0) return std::nullopt;
    return sum / count;
}

ErrorMeasures mean_measures(const std::vector<FrameComparison>& frames, ErrorMeasures FrameComparison::*part) {
    const auto mean = [&](std::optional<double> ErrorMeasures::*measure) {
        return mean_of(frames, [&](const FrameComparison& frame) { return frame.*part.*measure; });
    };
    return {mean(&ErrorMeasures::flip), mean(&ErrorMeasures::psnr_db), mean(&ErrorMeasures::ssim),
            mean(&ErrorMeasures::relative_rms)};
}

}  // namespace

FrameComparison compare_pictures(const ComparedPair& pair, const FlipOptions& options, ImageF* flip_map) {
    ImageF map = flip_error_map(pair.reference, pair.test, options);
    FrameComparison comparison;
    comparison.whole = measure(pair, map, nullptr);
    if (pair.mask != nullptr) {
        const Image8 outside = inverted_mask(*pair.mask);
        comparison.mask_share = mask_share(*pair.mask);
        comparison.inside = measure(pair, map, pair.mask);
        comparison.outside = measure(pair, map, &outside);
        if (pair.plate != nullptr) comparison.outside_plate_psnr_db = psnr_db(*pair.plate, pair.test, &outside);
    }
    if (flip_map != nullptr) *flip_map = std::move(map);
    return comparison;
}

FrameComparison mean_comparison(const std::vector<FrameComparison>& frames) {
    FrameComparison mean;
    mean.whole = mean_measures(frames, &FrameComparison::whole);
    mean.inside = mean_measures(frames, &FrameComparison::inside);
    mean.outside = mean_measures(frames, &FrameComparison::outside);
    mean.mask_share = mean_of(frames, [](const FrameComparison& frame) { return frame.mask_share; });
    mean.outside_plate_psnr_db =
        mean_of(frames, [](const FrameComparison& frame) { return frame.outside_plate_psnr_db; });
    return mean;
}

}  // namespace matchlight
