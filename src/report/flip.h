// LDR-FLIP: the difference that people see when they flip between two images.
//
// Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: A Difference Evaluator for Alternating
// Images", Proceedings of the ACM on Computer Graphics and Interactive Techniques 3(2), 2020.
#pragma once

#include "core/image.h"

namespace matchlight {

struct FlipOptions {
    /// Of the viewer; the authors' own default is a 0.7 m wide 3840-pixel display seen from 0.7 m: 3840·π/180.
    double pixels_per_degree = 67.0206432765823;

    /// Resolutions that a display can have and the filters can hold (a radius of 1 to 150 pixels).
    static constexpr double smallest_pixels_per_degree = 1;
    static constexpr double largest_pixels_per_degree = 1000;
};

/// The error of every pixel, 0 (none) to 1 (black against white), 1 channel. Both images are sRGB codes, 3 channels,
/// and of one size. The result does not depend on the number of threads.
ImageF flip_error_map(const Image8& reference, const Image8& test, const FlipOptions& options = {});

/// The same of the display's linear light, 0..1 (cut to it); no sample may be NaN.
ImageF flip_error_map_of_light(const ImageF& reference, const ImageF& test, const FlipOptions& options = {});

}  // namespace matchlight
