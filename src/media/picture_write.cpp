// PNG through OpenImageIO, encoded in memory and then written by checked calls: OpenImageIO's own close() reports
// success on a full disk.
#include <string_view>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "media/image_io.h"

namespace matchlight {

namespace {

// zlib's level 4 takes a third of the time of the default 6 and costs a few per cent of size.
constexpr int png_compression_level = 4;

template <class Sample>
void write_png(const std::filesystem::path& path, const Image<Sample>& pixels, const ImageMetadata& metadata,
               double pixels_per_inch = 0) {
    assert(!pixels.empty() && (pixels.channels() == 1 || pixels.channels() == 3 || pixels.channels() == 4));
    const OIIO::TypeDesc type = sizeof(Sample) == 1 ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16;
    OIIO::ImageSpec spec(pixels.width(), pixels.height(), pixels.channels(), type);
    spec.attribute("png:compressionLevel", png_compression_level);
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("oiio:UnassociatedAlpha", 1);
    for (const auto& [key, value] : metadata) spec.attribute(key, value);
    if (pixels_per_inch > 0) {
        spec.attribute("ResolutionUnit", "inch");
        for (const char* axis : {"XResolution", "YResolution"}) {
            spec.attribute(axis, static_cast<float>(pixels_per_inch));
        }
    }

    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const auto output = OIIO::ImageOutput::create("png", &memory);
    if (!output) throw InputError(path, "cannot be written: " + OIIO::geterror());
    const bool written =
        output->open(path.string(), spec) && output->write_image(type, pixels.samples().data()) && output->close();
    if (!written) throw InputError(path, "cannot be encoded as PNG: " + output->geterror());
    write_text_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace

void write_png8(const std::filesystem::path& path, const Image8& pixels, const ImageMetadata& metadata,
                double pixels_per_inch) {
    write_png(path, pixels, metadata, pixels_per_inch);
}

void write_png16(const std::filesystem::path& path, const Image16& pixels, const ImageMetadata& metadata) {
    write_png(path, pixels, metadata);
}

}  // namespace matchlight
