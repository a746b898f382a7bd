// The calls into libapriltag, and the conversion of its corners.
#include "tracking/tag_detector.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <apriltag/apriltag.h>

#include "core/transforms.h"

namespace matchlight {

namespace {

/// A decode whose bits lie this close to the threshold (in 8-bit steps) is noise that happens to spell a code.
constexpr double minimum_decision_margin = 4;

}  // namespace

TagDetector::TagDetector(const std::string& family, const TagDetectorOptions& options)
    : family_(family), options_(options), detector_(apriltag_detector_create(), apriltag_detector_destroy) {
    apriltag_detector_add_family_bits(detector_.get(), family_.get(), family_.allowed_hamming());
    detector_->nthreads = 1;
    detector_->refine_edges = true;
}

TagDetector::~TagDetector() {
    apriltag_detector_remove_family(detector_.get(), family_.get());
}

std::vector<TagDetection> TagDetector::detect(const Image8& light8) const {
    constexpr int smallest_side = 16;  // the library thresholds in tiles and expects a few of them
    if (std::min(light8.width(), light8.height()) < smallest_side) return {};
    const double pixels = static_cast<double>(light8.width()) * light8.height();
    detector_->quad_decimate = options_.decimation > 0 ? options_.decimation : (pixels > 1.1e6 ? 2 : 1);
    // The library takes a mutable buffer but only reads it.
    image_u8_t view = {light8.width(), light8.height(), light8.width(),
                       const_cast<std::uint8_t*>(light8.samples().data())};
    zarray_t* found = apriltag_detector_detect(detector_.get(), &view);
    std::vector<TagDetection> detections;
    for (int i = 0; i < zarray_size(found); ++i) {
        apriltag_detection_t* raw = nullptr;
        zarray_get(found, i, &raw);
        if (raw->hamming > family_.allowed_hamming() || raw->decision_margin < minimum_decision_margin) continue;
        TagDetection detection;
        detection.id = raw->id;
        detection.hamming = raw->hamming;
        detection.decision_margin = raw->decision_margin;
        for (std::size_t c = 0; c < 4; ++c) {
            detection.corners_px[c] = pixel_from_detector({raw->p[c][0], raw->p[c][1]});
        }
        detections.push_back(detection);
    }
    apriltag_detections_destroy(found);
    std::ranges::sort(detections, {}, [](const TagDetection& detection) {
        return std::tuple(detection.id, detection.corners_px[0].x(), detection.corners_px[0].y());
    });
    return detections;
}

Image8 detection_image(const ImageF& light, DetectionScale scale) {
    Image8 light8(light.width(), light.height(), 1);
    if (scale == DetectionScale::perceptual) {
        std::ranges::transform(light.samples(), light8.samples().begin(), [](float value) {
            return static_cast<std::uint8_t>(std::lround(255 * std::sqrt(std::clamp(value, 0.0f, 1.0f))));
        });
        return light8;
    }
    // A histogram of the light on a grid of pixels; light is 0..1 of what the camera can record.
    constexpr int bins = 1024;
    constexpr int step = 4;
    std::vector<int> counts(bins, 0);
    int total = 0;
    for (int y = 0; y < light.height(); y += step) {
        for (int x = 0; x < light.width(); x += step) {
            const float value = light.at(x, y);
            ++counts[static_cast<std::size_t>(std::clamp(value, 0.0f, 1.0f) * (bins - 1))];
            ++total;
        }
    }
    // A thousandth of the frame may be brighter than the scale's end: the paper of even a small tag is more.
    int above = 0;
    int bin = bins - 1;
    while (bin > 0 && above + counts[static_cast<std::size_t>(bin)] <= total / 1000) {
        above += counts[static_cast<std::size_t>(bin)];
        --bin;
    }
    const float gain = 255.0f * (bins - 1) / static_cast<float>(std::max(bin + 1, 8));
    std::ranges::transform(light.samples(), light8.samples().begin(), [&](float value) {
        return static_cast<std::uint8_t>(std::clamp(value * gain + 0.5f, 0.0f, 255.0f));
    });
    return light8;
}

}  // namespace matchlight
