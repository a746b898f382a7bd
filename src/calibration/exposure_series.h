// A bracketed set of photographs: the same scene, exposed differently.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/warnings.h"
#include "media/photograph.h"

namespace matchlight {

/// One photograph of a series.
struct Photograph {
    std::filesystem::path path;
    ExposureRecord record;  // 0: not known
    double exposure = 0;    // light gathered, s·(ISO/100)/N²; what code-1 light is divided by to get radiance
    ImageF code;            // RGB, 0..1 of full scale, upright
    bool linear = false;    // code is proportional to light (raw files): no response applies
    double code_step = 1.0 / 255;
    bool subsampled = false;  // chroma shared by several pixels
};

struct ExposureSeries {
    std::vector<Photograph> shots;  // the longest exposure first
    int width() const { return shots.front().code.width(); }
    int height() const { return shots.front().code.height(); }
};

/// What the user says of the exposures; it replaces what the files record. Each list is empty, or holds one entry a
/// photograph in the order of their names; f-numbers and ISO also one for all.
struct ExposureOptions {
    std::vector<double> times_s;
    std::vector<double> f_numbers;
    std::vector<double> isos;
};

/// "1/30", "2/15", "0.5" or "32": seconds. Throws InputError for anything else, zero and less.
double seconds_from_text(const std::string& text);

/// Reads and orders the photographs. Throws InputError: no photograph, one that cannot be read, one given twice, sizes
/// that differ, raw files beside developed ones, a time that is missing or not positive, f-number or ISO known for
/// some photographs only while it differs between those, all exposures equal. One photograph alone is a warning.
ExposureSeries read_exposure_series(const std::vector<std::filesystem::path>& photographs, const ExposureOptions& given,
                                    Warnings& warnings);

}  // namespace matchlight
