// A photograph with what its camera recorded of the exposure, from a picture file or a camera's raw file.
#pragma once

#include <filesystem>

#include "core/image.h"

namespace matchlight {

/// How long, through what aperture and how strongly amplified a photograph was taken. 0: not known.
struct ExposureRecord {
    double exposure_s = 0;
    double f_number = 0;
    double iso = 0;
};

/// A photograph as it lies in its file, upright.
struct PhotographFile {
    ImageF code;  // RGB, 0..1 of full scale
    ExposureRecord exposure;
    bool linear = false;      // developed from a raw file: code is proportional to light, Rec.709 primaries
    double code_step = 0;     // between neighbouring codes, as a part of full scale
    bool subsampled = false;  // its chroma is shared by several pixels (JPEG)
};

/// Reads a picture that read_rgb8 reads, or, where OpenImageIO was built with LibRaw, a raw file (recognised by its
/// extension), developed without any step that depends on what the picture shows: daylight white balance, no automatic
/// brightening. Throws InputError.
PhotographFile read_photograph(const std::filesystem::path& path);

}  // namespace matchlight
