// Still pictures in code values through OpenImageIO.
#include <algorithm>
#include <string>

#include <OpenImageIO/imageio.h>

#include "core/error.h"
#include "media/image_io.h"
#include "media/input_limits.h"
#include "media/open_picture.h"
#include "media/orientation.h"
#include "media/picture_format.h"

namespace matchlight {

namespace {

namespace fs = std::filesystem;

const char* reader_name(PictureFormat format, const fs::path& path) {
    switch (format) {
        case PictureFormat::png:
            return "png";
        case PictureFormat::jpeg:
            return "jpeg";
        case PictureFormat::tiff:
            return "tiff";
        case PictureFormat::bmp:
            return "bmp";
        case PictureFormat::pnm:
            return "pnm";
        case PictureFormat::targa:
            return "targa";
        case PictureFormat::webp:
            return "webp";
        case PictureFormat::radiance:
        case PictureFormat::exr:
            break;
    }
    throw InputError(path, "holds scene-linear light, not a picture", "give a PNG, JPEG or TIFF");
}

}  // namespace

OpenPicture open_picture(const fs::path& path) {
    OpenPicture picture;
    const PictureFormat format = recognise_picture(path);
    const char* reader = reader_name(format, path);
    require_whole_picture(path, format);
    OIIO::ImageSpec wanted;
    wanted.attribute("oiio:UnassociatedAlpha", 1);  // colour must not be multiplied by alpha
    picture.input = OIIO::ImageInput::create(reader);
    if (!picture.input || !picture.input->open(path.string(), picture.spec, wanted))
        throw InputError(
            path, "is no readable picture (" + (picture.input ? picture.input->geterror() : OIIO::geterror()) + ")");
    check_image_size(path, picture.spec.width, picture.spec.height);
    if (picture.spec.nchannels < 1 || picture.spec.nchannels > 4)
        throw InputError(path, "has " + std::to_string(picture.spec.nchannels) + " channels", "save it as RGB");
    picture.orientation = picture.spec.get_int_attribute("Orientation", 1);
    return picture;
}

namespace {

template <class Sample>
Image<Sample> read_rgb(const fs::path& path) {
    OpenPicture picture = open_picture(path);
    const int channels = picture.spec.nchannels;
    const int colours = channels >= 3 ? 3 : 1;
    const OIIO::TypeDesc type = sizeof(Sample) == 1 ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16;
    Image<Sample> image(picture.spec.width, picture.spec.height, colours);
    if (!picture.input->read_image(0, 0, 0, colours, type, image.samples().data()))
        throw InputError(path, "its pixels are damaged or cut off (" + picture.input->geterror() + ")");
    if (colours == 1) {
        Image<Sample> rgb(image.width(), image.height(), 3);
        for (std::size_t i = 0; i < image.samples().size(); ++i)
            std::fill_n(rgb.samples().begin() + static_cast<std::ptrdiff_t>(3 * i), 3, image.samples()[i]);
        image = std::move(rgb);
    }
    return oriented(std::move(image), picture.orientation);
}

}  // namespace

Image8 read_rgb8(const fs::path& path) {
    return read_rgb<std::uint8_t>(path);
}

Image16 read_rgb16(const fs::path& path) {
    return read_rgb<std::uint16_t>(path);
}

int picture_bit_depth(const fs::path& path) {
    return open_picture(path).spec.format.basesize() == 1 ? 8 : 16;
}

Image8 read_mask(const fs::path& path) {
    const Image8 rgb = read_rgb8(path);
    Image8 mask(rgb.width(), rgb.height(), 1);
    for (int y = 0; y < rgb.height(); ++y) {
        for (int x = 0; x < rgb.width(); ++x) {
            const std::uint8_t* p = rgb.pixel(x, y);
            mask.at(x, y) = (p[0] | p[1] | p[2]) != 0 ? 255 : 0;
        }
    }
    return mask;
}

}  // namespace matchlight
