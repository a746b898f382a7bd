// Scene-linear RGB from EXR and Radiance files, with non-finite samples repaired where they enter.
#include <cmath>
#include <string_view>
#include <utility>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfEnvmapAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "core/error.h"
#include "media/exr_file.h"
#include "media/image_io.h"
#include "media/input_limits.h"
#include "media/orientation.h"
#include "media/picture_format.h"

namespace matchlight {

namespace {

namespace fs = std::filesystem;

constexpr float half_max = 65504.0f;  // largest finite IEEE 754 binary16

struct RgbChannels {
    int part = 0;
    std::vector<std::string> names;  // R, G, B, or one luminance
};

/// R, G and B of a part: plain, or of its first layer ("beauty.R").
std::vector<std::string> rgb_names(const ExrFile& file, int part) {
    if (file.has_channel(part, "R") && file.has_channel(part, "G") && file.has_channel(part, "B"))
        return {"R", "G", "B"};
    const auto& channels = file.header(part).channels();
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        const std::string name = channel.name();
        if (!name.ends_with(".R")) continue;
        const std::string layer = name.substr(0, name.size() - 1);
        if (file.has_channel(part, layer + "G") && file.has_channel(part, layer + "B"))
            return {name, layer + "G", layer + "B"};
    }
    return {};
}

RgbChannels find_rgb(const ExrFile& file, const fs::path& path) {
    for (int part = 0; part < file.parts(); ++part) {
        if (auto names = rgb_names(file, part); !names.empty()) return {part, std::move(names)};
    }
    for (int part = 0; part < file.parts(); ++part) {
        if (file.has_channel(part, "Y")) return {part, {"Y"}};
    }
    throw InputError(path, "has neither RGB nor luminance channels", "export it with channels R, G, B");
}

void check_primaries(const ExrFile& file, int part, const fs::path& path, Warnings& warnings) {
    if (!Imf::hasChromaticities(file.header(part))) return;
    const Imf::Chromaticities found = Imf::chromaticities(file.header(part));
    const Imf::Chromaticities rec709;
    // Published roundings of the same primaries differ in the third decimal.
    constexpr float same = 2e-3f;
    if (!found.red.equalWithAbsError(rec709.red, same) || !found.green.equalWithAbsError(rec709.green, same) ||
        !found.blue.equalWithAbsError(rec709.blue, same))
        warnings.add(path.string() + ": its primaries are not those of Rec.709; its RGB is taken as it is");
}

/// Luminance with half-resolution chroma, as OpenEXR's own YCA files have it.
ImageF read_luminance_chroma(const fs::path& path) {
    try {
        Imf::RgbaInputFile file(path.c_str());
        const Imath::Box2i window = file.dataWindow();
        ImageF image(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, 3);
        std::vector<Imf::Rgba> row(static_cast<std::size_t>(image.width()));
        for (int y = 0; y < image.height(); ++y) {
            // A negative index base: OpenEXR addresses pixels by their coordinates in the data window.
            file.setFrameBuffer(row.data() - window.min.x, 1, 0);
            file.readPixels(window.min.y + y);
            for (int x = 0; x < image.width(); ++x) {
                image.at(x, y, 0) = row[x].r;
                image.at(x, y, 1) = row[x].g;
                image.at(x, y, 2) = row[x].b;
            }
        }
        return image;
    } catch (const std::exception& error) {
        throw InputError(path, fmt::format("its pixels are damaged or cut off ({})", error.what()), "export it again");
    }
}

ImageF spread_gray(const ImageF& gray) {
    ImageF rgb(gray.width(), gray.height(), 3);
    for (std::size_t i = 0; i < gray.samples().size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) rgb.samples()[3 * i + c] = gray.samples()[i];
    }
    return rgb;
}

ImageF read_exr_rgb(const fs::path& path, Warnings& warnings) {
    const ExrFile file(path);
    const RgbChannels rgb = find_rgb(file, path);
    check_primaries(file, rgb.part, path, warnings);
    if (rgb.names.size() == 3) return file.read(rgb.part, rgb.names);
    if (file.has_channel(rgb.part, "RY") && file.has_channel(rgb.part, "BY")) return read_luminance_chroma(path);
    return spread_gray(file.read(rgb.part, rgb.names));
}

ImageF read_radiance(const fs::path& path) {
    const auto input = OIIO::ImageInput::create("hdr");
    OIIO::ImageSpec spec;
    if (!input || !input->open(path.string(), spec))
        throw InputError(path, "is no readable Radiance file (" + (input ? input->geterror() : OIIO::geterror()) + ")",
                         "export it again");
    check_image_size(path, spec.width, spec.height);
    if (spec.nchannels != 3) throw InputError(path, "has no RGB channels");
    ImageF image(spec.width, spec.height, 3);
    if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, image.samples().data()))
        throw InputError(path, "its pixels are damaged or cut off (" + input->geterror() + ")", "export it again");
    // The header's resolution line may run bottom up, right to left or by columns; OpenImageIO tells it as EXIF does.
    return oriented(std::move(image), spec.get_int_attribute("Orientation", 1));
}

SampleRepairs repair(ImageF& image, const fs::path& path, Warnings& warnings) {
    SampleRepairs repairs;
    for (float& sample : image.samples()) {
        if (std::abs(sample) <= half_max) continue;  // false for NaN
        if (std::isnan(sample)) {
            sample = 0;
            ++repairs.not_a_number;
        } else if (std::isinf(sample)) {
            sample = std::copysign(half_max, sample);
            ++repairs.infinite;
        } else {
            ++repairs.beyond_half;
        }
    }
    const std::string name = path.string();
    if (repairs.not_a_number > 0)
        warnings.add(fmt::format("{}: {} samples are NaN and were set to 0", name, repairs.not_a_number));
    if (repairs.infinite > 0)
        warnings.add(fmt::format("{}: {} samples are infinite and were set to 65504", name, repairs.infinite));
    if (repairs.beyond_half > 0)
        warnings.add(
            fmt::format("{}: {} samples lie beyond 65504, which half floats cannot hold", name, repairs.beyond_half));
    return repairs;
}

}  // namespace

ImageF read_linear_rgb(const fs::path& path, Warnings& warnings, SampleRepairs* repairs) {
    const PictureFormat format = recognise_picture(path);
    ImageF image;
    if (format == PictureFormat::exr) {
        image = read_exr_rgb(path, warnings);
    } else if (format == PictureFormat::radiance) {
        image = read_radiance(path);
    } else {
        throw InputError(path, "is neither EXR nor Radiance HDR", "give a file of scene-linear light");
    }
    const SampleRepairs counted = repair(image, path, warnings);
    if (repairs != nullptr) *repairs = counted;
    return image;
}

ImageF read_exr_part(const fs::path& path, const std::string& part, const std::vector<std::string>& channels) {
    const ExrFile file(path);
    for (int index = 0; index < file.parts(); ++index) {
        if (file.part_name(index) == part) return file.read(index, channels);
    }
    throw InputError(path, "has no part named \"" + part + "\"");
}

std::optional<std::string> exr_envmap(const fs::path& path) {
    if (recognise_picture(path) != PictureFormat::exr) return std::nullopt;
    const ExrFile file(path);
    if (!Imf::hasEnvmap(file.header(0))) return std::nullopt;
    return Imf::envmap(file.header(0)) == Imf::ENVMAP_CUBE ? "cube" : "latlong";
}

}  // namespace matchlight
