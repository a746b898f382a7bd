// Probe files: recognising the mapping of an image, repairing what cannot be light, and writing any layout.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/warnings.h"
#include "lighting/mappings.h"
#include "lighting/probe.h"
#include "media/image_io.h"

namespace matchlight {

/// A probe's image as it lies in its file, repaired.
struct ProbeImage {
    ImageF image;  // RGB, no negative and no non-finite samples
    ProbeLayout layout;
    std::string recognised_by;  // "asked for", "envmap attribute", "mapping attribute", "shape", "shape and name"
    SampleRepairs repairs;
    std::int64_t negative_samples = 0;  // set to 0
};

/// Reads .hdr or .exr. The mapping is, in this order: the one given; OpenEXR's `envmap` attribute; the `mapping`
/// attribute that write_probe_image leaves; the shape: 2:1 lat-long, 3:4, 4:3, 6:1 and 1:6 cube, 1:1 a disc with dark
/// or constant corners. A disc is taken as angular, because angular maps and mirror balls look alike, unless the file's
/// name holds "mirrorball" or "chromeball" (in any case, with or without separators). Throws InputError.
ProbeImage read_probe_image(const std::filesystem::path& path, std::optional<ProbeMapping> mapping, Warnings& warnings);

/// The lat-long map that a probe of this layout is unwrapped to: as it is where it has that layout, else of what it
/// holds, at most 8192 × 4096.
ProbeLayout latlong_layout_for(const ProbeLayout& layout);

/// The image as a lat-long probe of that layout.
Probe unwrapped(const ProbeImage& file);

/// Throws InputError unless the name ends in .exr or .hdr.
void require_probe_extension(const std::filesystem::path& path);

/// Channels that an EXR file keeps beside R, G and B, as they are stored.
struct RecordedChannels {
    std::vector<std::string> names;  // of "sigma", "seen", "clipped", "distance_m"
    ImageF image;                    // as many channels; empty where there are none
};

/// Of a probe's file that has this layout; none for any other format.
RecordedChannels recorded_channels(const std::filesystem::path& path, const ProbeLayout& layout);

/// Writes .exr (half where the radiance fits, else float) or .hdr by the file's extension, whole or not at all. The
/// mapping is recorded in EXR files beside `metadata` and the `beside` channels. Throws InputError.
void write_probe_image(const std::filesystem::path& path, const ImageF& image, const ProbeLayout& layout,
                       ImageMetadata metadata, const RecordedChannels& beside = {});

}  // namespace matchlight
