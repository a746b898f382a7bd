// What a built probe says of itself beside its light: how sure it is of each pixel, and where it comes from.
#pragma once

#include <filesystem>
#include <optional>

#include "core/image.h"
#include "lighting/probe_file.h"
#include "media/image_io.h"

namespace matchlight {

/// As `probe build` writes it; each is absent where the file does not have it. Images are lat-long, of the probe's size
/// as unwrapped() gives it, 1 channel.
struct ProbeRecord {
    std::optional<ImageF> sigma;    // relative standard deviation of luminance
    std::optional<ImageF> seen;     // 1: measured, 0: filled in
    std::optional<ImageF> clipped;  // 1: the light is a lower bound
    /// 1/m: one over the distance of what is seen from the probe's place; 0: far away, or not known. Means of it are
    /// what resampling and half-covered pixels want; distances have none, because far away is infinitely far.
    std::optional<ImageF> nearness;
    ImageMetadata metadata;  // strings of the header
};

/// Nearness in channel `c` becomes the file's channel `distance_m`: metres, 0 where nearness is 0, and where a half
/// float does not hold it, past 65 km.
void store_distances(RecordedChannels& channels, int c);

/// Of an EXR file; empty for any other. Throws InputError.
ProbeRecord read_probe_record(const std::filesystem::path& path, const ProbeImage& file);

/// Shares of the sphere.
struct ProbeCoverage {
    double clipped = 0;
    std::optional<double> unseen;        // nullopt: the probe does not say
    std::optional<double> median_sigma;  // of what was seen, relative
};

/// What a probe knows of distances.
struct ProbeDistances {
    double known_share = 0;            // of the sphere
    double least_m = 0, median_m = 0;  // of that
};

/// nullopt where it knows none.
std::optional<ProbeDistances> distances_of(const ProbeRecord& record);

/// By the record; what is clipped, where that does not say, by flat tops of `latlong`.
ProbeCoverage coverage_of(const ProbeRecord& record, const ImageF& latlong);

/// 1 where a pixel is clipped, by the record or else by flat tops.
ImageF clipped_map(const ProbeRecord& record, const ImageF& latlong);

}  // namespace matchlight
