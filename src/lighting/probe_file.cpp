// What a probe file is, by metadata first, then by shape and content.
#include "lighting/probe_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <vector>

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/lowercase.h"
#include "core/transfer.h"
#include "lighting/resample.h"
#include "media/exr_file.h"
#include "media/picture_format.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* mapping_attribute = "mapping";
constexpr const char* say_which = "say which it is with --from, or `mapping` in the scene";

/// Crops are often off by a pixel or two; 1 % of stretch moves light by half a degree.
constexpr double aspect_tolerance = 0.01;

bool has_aspect(int width, int height, double aspect) {
    return std::abs(static_cast<double>(width) / height / aspect - 1) <= aspect_tolerance;
}

/// Whether the background, dark or of one colour, fills the corners around an inscribed disc and not the disc's rim.
bool shows_a_disc(const ImageF& image) {
    const auto luminance = [&](int x, int y) {
        const float* p = image.pixel(x, y);
        return luminance_rec709(p[0], p[1], p[2]);
    };
    double inside_sum = 0;
    std::int64_t inside_count = 0;
    std::vector<double> corners;
    std::vector<double> rim;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            const double radius = std::hypot((2 * x + 1.0) / image.width() - 1, (2 * y + 1.0) / image.height() - 1);
            if (radius < 1) {
                inside_sum += luminance(x, y);
                ++inside_count;
            }
            // A margin of 3 % on either side of the rim: circles are drawn and cropped by hand.
            if (radius > 1.03) corners.push_back(luminance(x, y));
            if (radius > 0.93 && radius < 0.97) rim.push_back(luminance(x, y));
        }
    }
    if (corners.empty() || rim.empty() || inside_sum <= 0) return inside_sum <= 0;
    const double mean = inside_sum / static_cast<double>(inside_count);
    std::nth_element(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(corners.size() / 2), corners.end());
    const double middle = corners[corners.size() / 2];
    const auto is_background = [&](double l) { return l <= 1e-3 * mean || std::abs(l - middle) <= 0.02 * middle; };
    const auto background = [&](const std::vector<double>& set) {
        return static_cast<double>(std::count_if(set.begin(), set.end(), is_background)) /
               static_cast<double>(set.size());
    };
    // A fifth of the corners may hold a caption; a fifth of the rim must show something.
    return background(corners) >= 0.8 && background(rim) <= 0.8;
}

bool name_says_mirror_ball(const fs::path& path) {
    std::string letters;
    for (const char c : lowercase(path.stem().string())) {
        if (std::isalnum(static_cast<unsigned char>(c))) letters += c;
    }
    return letters.find("mirrorball") != std::string::npos || letters.find("chromeball") != std::string::npos;
}

std::optional<ProbeMapping> recorded_mapping(const fs::path& path) {
    if (recognise_picture(path) != PictureFormat::exr) return std::nullopt;
    const ExrFile file(path);
    const auto* text = file.header(0).findTypedAttribute<Imf::StringAttribute>(mapping_attribute);
    return text ? probe_mapping_from_name(text->value()) : std::nullopt;
}

/// The layout of an image that is known to be of `mapping`.
ProbeLayout layout_as(const fs::path& path, const ImageF& image, ProbeMapping mapping) {
    ProbeLayout layout{mapping, CubeLayout::vertical_cross, image.width(), image.height(), false};
    const auto wrong = [&](const char* expected) {
        return InputError(path,
                          fmt::format("{} × {} pixels cannot be a probe of mapping {}", image.width(), image.height(),
                                      name_of(mapping)),
                          fmt::format("expected {}; {}", expected, say_which));
    };
    switch (mapping) {
        case ProbeMapping::latlong:
            if (!has_aspect(image.width(), image.height(), 2)) throw wrong("2:1");
            break;
        case ProbeMapping::angular:
        case ProbeMapping::mirrorball:
            if (!has_aspect(image.width(), image.height(), 1)) throw wrong("a square");
            // Below this no pixel centre is sure to lie within the disc.
            if (std::min(image.width(), image.height()) < 4) throw wrong("at least 4 × 4");
            break;
        case ProbeMapping::cube: {
            const auto cube = cube_layout_of_shape(image.width(), image.height());
            if (!cube) throw wrong("a cross of 3:4 or 4:3, a 6:1 strip or a 1:6 column of square faces");
            layout.cube = *cube;
            break;
        }
    }
    return layout;
}

struct Recognised {
    ProbeMapping mapping;
    const char* by;
};

Recognised recognise_by_shape(const fs::path& path, const ImageF& image) {
    if (has_aspect(image.width(), image.height(), 2)) return {ProbeMapping::latlong, "shape"};
    if (cube_layout_of_shape(image.width(), image.height())) return {ProbeMapping::cube, "shape"};
    if (has_aspect(image.width(), image.height(), 1)) {
        if (!shows_a_disc(image)) {
            throw InputError(path,
                             "a square image, but no ball or angular map: looked for a disc that touches all four "
                             "sides, with dark or even corners",
                             fmt::format("crop it to the ball, or {}", say_which));
        }
        if (name_says_mirror_ball(path)) return {ProbeMapping::mirrorball, "shape and name"};
        return {ProbeMapping::angular, "shape"};
    }
    throw InputError(path, fmt::format("{} × {} pixels fit no mapping of light probes", image.width(), image.height()),
                     "expected 2:1 (lat-long), 1:1 (angular or mirror ball), 3:4, 4:3, 6:1 or 1:6 (cube)");
}

Recognised recognise(const fs::path& path, const ImageF& image, std::optional<ProbeMapping> given,
                     const std::optional<std::string>& envmap) {
    if (given) return {*given, "asked for"};
    if (envmap) return {*envmap == "cube" ? ProbeMapping::cube : ProbeMapping::latlong, "envmap attribute"};
    if (const auto recorded = recorded_mapping(path)) return {*recorded, "mapping attribute"};
    return recognise_by_shape(path, image);
}

void write_radiance_hdr(const fs::path& path, const ImageF& image) {
    PendingFile pending(path);
    const auto output = OIIO::ImageOutput::create("hdr");
    const OIIO::ImageSpec spec(image.width(), image.height(), 3, OIIO::TypeDesc::FLOAT);
    const bool written = output && output->open(pending.path().string(), spec) &&
                         output->write_image(OIIO::TypeDesc::FLOAT, image.samples().data()) && output->close();
    if (!written)
        throw InputError(path, "could not be written (" + (output ? output->geterror() : OIIO::geterror()) + ")");
    // OpenImageIO reports success on a full disk: only reading it again tells.
    Warnings unheard;
    unheard.set_quiet(true);
    const ImageF again = read_linear_rgb(pending.path(), unheard);
    if (again.bounds() != image.bounds()) throw InputError(path, "could not be written whole", "free some disk space");
    pending.commit();
}

}  // namespace

ProbeImage read_probe_image(const fs::path& path, std::optional<ProbeMapping> mapping, Warnings& warnings) {
    ProbeImage probe;
    probe.image = read_linear_rgb(path, warnings, &probe.repairs);
    const auto envmap = exr_envmap(path);
    const Recognised recognised = recognise(path, probe.image, mapping, envmap);
    probe.layout = layout_as(path, probe.image, recognised.mapping);
    probe.recognised_by = recognised.by;
    if (envmap && probe_mapping_from_name(*envmap) == recognised.mapping) {
        const int least = recognised.mapping == ProbeMapping::cube ? probe.layout.face_size() : probe.layout.height;
        probe.layout.edge_centred = least >= 2;  // one pixel has no edges to lie on
    }
    for (float& sample : probe.image.samples()) {
        if (sample < 0) {
            sample = 0;
            ++probe.negative_samples;
        }
    }
    if (probe.negative_samples > 0) {
        warnings.add(
            fmt::format("{}: {} samples are negative and were set to 0", path.string(), probe.negative_samples));
    }
    return probe;
}

ProbeLayout latlong_layout_for(const ProbeLayout& layout) {
    constexpr int largest_unwrapped = 4096;  // 400 MB
    int height = latlong_height_for(layout);
    if (layout.mapping != ProbeMapping::latlong) height = std::min(height, largest_unwrapped);
    return layout_of_size(ProbeMapping::latlong, height);
}

Probe unwrapped(const ProbeImage& file) {
    return probe_from_image(file.image, file.layout, latlong_layout_for(file.layout).height);
}

Probe load_probe(const fs::path& path, std::optional<ProbeMapping> mapping, Warnings& warnings) {
    return unwrapped(read_probe_image(path, mapping, warnings));
}

void require_probe_extension(const fs::path& path) {
    const std::string extension = lowercase(path.extension().string());
    if (extension != ".exr" && extension != ".hdr") throw InputError(path, "probes are written as .exr or .hdr");
}

RecordedChannels recorded_channels(const fs::path& path, const ProbeLayout& layout) {
    RecordedChannels recorded;
    if (recognise_picture(path) != PictureFormat::exr) return recorded;
    const ExrFile exr(path);
    for (const char* name : {"sigma", "seen", "clipped", "distance_m"}) {
        if (exr.has_channel(0, name)) recorded.names.emplace_back(name);
    }
    if (recorded.names.empty()) return recorded;
    recorded.image = exr.read(0, recorded.names);
    if (recorded.image.width() != layout.width || recorded.image.height() != layout.height) return {};
    return recorded;
}

void write_probe_image(const fs::path& path, const ImageF& image, const ProbeLayout& layout, ImageMetadata metadata,
                       const RecordedChannels& beside) {
    require_probe_extension(path);
    if (lowercase(path.extension().string()) == ".hdr") {
        write_radiance_hdr(path, image);
        return;
    }
    metadata[mapping_attribute] = name_of(layout.mapping);
    constexpr float half_max = 65504;
    const bool fits_half =
        std::all_of(image.samples().begin(), image.samples().end(), [](float sample) { return sample <= half_max; });
    std::vector<std::string> names = {"R", "G", "B"};
    if (beside.image.empty()) {
        write_exr(path, image.width(), image.height(), {{"rgb", names, &image, fits_half, {}}}, metadata);
        return;
    }
    names.insert(names.end(), beside.names.begin(), beside.names.end());
    const int channels = static_cast<int>(names.size());
    ImageF all(image.width(), image.height(), channels);
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            std::copy_n(image.pixel(x, y), 3, all.pixel(x, y));
            std::copy_n(beside.image.pixel(x, y), channels - 3, all.pixel(x, y) + 3);
        }
    }
    write_exr(path, image.width(), image.height(), {{"rgb", names, &all, fits_half, {}}}, metadata);
}

}  // namespace matchlight
