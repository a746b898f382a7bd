// Finds the tags of one family in a frame with AprilTag's library.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calibration/tag_family.h"
#include "core/image.h"

struct apriltag_detector;

namespace matchlight {

/// A tag as the library saw it. Corners follow tag_corners_m: counter-clockwise from the lower left of the printed
/// sheet, pixel centres at whole numbers.
struct TagDetection {
    int id = 0;
    std::array<Eigen::Vector2d, 4> corners_px;
    int hamming = 0;             // bits corrected
    double decision_margin = 0;  // mean distance of a bit from the threshold, in 8-bit steps
};

struct TagDetectorOptions {
    /// Quads are sought in an image this much smaller; 0 chooses: 1 up to 1 megapixel, 2 above (NUMERICS: 29 instead
    /// of 134 ms at 1080p).
    int decimation = 0;
};

/// One detector a thread: the library keeps state between frames but no result depends on it.
class TagDetector {
public:
    TagDetector(const std::string& family, const TagDetectorOptions& options);
    ~TagDetector();
    TagDetector(const TagDetector&) = delete;
    TagDetector& operator=(const TagDetector&) = delete;

    const TagFamily& family() const { return family_; }

    /// `light8` is one channel, proportional to light, so that an edge lies where the ink ends. Detections with more
    /// wrong bits than the family allows or a margin within the noise are left out. Sorted by id, then position.
    std::vector<TagDetection> detect(const Image8& light8) const;

private:
    TagFamily family_;
    TagDetectorOptions options_;
    std::unique_ptr<apriltag_detector, void (*)(apriltag_detector*)> detector_;
};

/// How light becomes the 8 bits that the detector sees.
enum class DetectionScale {
    linear,      // proportional to light: edges lie where the ink ends; scaled so that the brightest surface that fills
                 // a noticeable part of the frame is not clipped, while a window or a lamp may be
    perceptual,  // square root of light: keeps steps for tags in deep shadow, at the price of biased corners
};
Image8 detection_image(const ImageF& light, DetectionScale scale = DetectionScale::linear);

}  // namespace matchlight
