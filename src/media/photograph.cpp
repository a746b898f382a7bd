// Pixels and EXIF of photographs through OpenImageIO.
#include "media/photograph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include <OpenImageIO/imageio.h>

#include "core/error.h"
#include "core/lowercase.h"
#include "media/image_io.h"
#include "media/input_limits.h"
#include "media/open_picture.h"
#include "media/orientation.h"
#include "media/picture_format.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

/// Raw files of the makers whose cameras are about. Most are TIFF files at heart, so their first bytes do not tell.
constexpr std::array<const char*, 21> raw_extensions = {".3fr", ".arw", ".cr2", ".cr3", ".crw", ".dcr", ".dng",
                                                        ".erf", ".iiq", ".kdc", ".mef", ".mos", ".mrw", ".nef",
                                                        ".nrw", ".orf", ".pef", ".raf", ".rw2", ".srw", ".x3f"};

bool is_raw_name(const fs::path& path) {
    const std::string extension = lowercase_extension(path);
    return std::find(raw_extensions.begin(), raw_extensions.end(), extension) != raw_extensions.end();
}

/// The first of two attributes that is there, positive and finite; 0 where neither is.
double positive_attribute(const OIIO::ImageSpec& spec, const char* name, const char* other) {
    for (const char* attribute : {name, other}) {
        const double value = spec.get_float_attribute(attribute, 0);
        if (std::isfinite(value) && value > 0) return value;
    }
    return 0;
}

/// EXIF 2.32 (CIPA DC-008): the plain tags, else the APEX ones, time = 2^−Tv and N = 2^(Av/2), which some cameras write
/// alone.
ExposureRecord recorded_exposure(const OIIO::ImageSpec& spec) {
    ExposureRecord record;
    record.exposure_s = positive_attribute(spec, "ExposureTime", "Exif:ExposureTime");
    record.f_number = positive_attribute(spec, "FNumber", "Exif:FNumber");
    record.iso = positive_attribute(spec, "Exif:PhotographicSensitivity", "Exif:ISOSpeedRatings");
    const auto* shutter = spec.find_attribute("Exif:ShutterSpeedValue");
    const auto* aperture = spec.find_attribute("Exif:ApertureValue");
    if (record.exposure_s == 0 && shutter != nullptr) record.exposure_s = std::exp2(-shutter->get_float());
    if (record.f_number == 0 && aperture != nullptr) record.f_number = std::exp2(aperture->get_float() / 2);
    if (!std::isfinite(record.exposure_s)) record.exposure_s = 0;
    if (!std::isfinite(record.f_number)) record.f_number = 0;
    return record;
}

template <class Sample>
ImageF scaled(const Image<Sample>& picture, double code_step) {
    ImageF code(picture.width(), picture.height(), 3);
    std::transform(picture.samples().begin(), picture.samples().end(), code.samples().begin(),
                   [code_step](Sample sample) { return static_cast<float>(sample * code_step); });
    return code;
}

PhotographFile read_developed(const fs::path& path) {
    PhotographFile photograph;
    const bool deep = picture_bit_depth(path) > 8;
    photograph.code_step = deep ? 1.0 / 65535 : 1.0 / 255;
    photograph.code =
        deep ? scaled(read_rgb16(path), photograph.code_step) : scaled(read_rgb8(path), photograph.code_step);
    const OIIO::ImageSpec spec = open_picture(path).spec;
    photograph.exposure = recorded_exposure(spec);
    photograph.subsampled = recognise_picture(path) == PictureFormat::jpeg &&
                            spec.get_string_attribute("jpeg:subsampling", "4:2:0") != "4:4:4";
    return photograph;
}

/// Nothing here may depend on what the picture shows, or two exposures would not be comparable.
PhotographFile read_raw(const fs::path& path) {
    require_regular_file(path);
    OIIO::ImageSpec wanted;
    wanted.attribute("raw:ColorSpace", "linear");
    wanted.attribute("raw:auto_bright", 0);
    wanted.attribute("raw:use_camera_wb", 0);          // LibRaw then takes the daylight balance of the model
    wanted.attribute("raw:adjust_maximum_thr", 0.0f);  // else full scale follows the brightest pixel
    wanted.attribute("raw:HighlightMode", 0);          // clip: what is clipped must be seen to be
    const auto input = OIIO::ImageInput::create("raw");
    OIIO::ImageSpec spec;
    if (!input) {
        throw InputError(path, "raw files cannot be read by the installed OpenImageIO",
                         "develop it to a linear 16-bit TIFF");
    }
    if (!input->open(path.string(), spec, wanted))
        throw InputError(path, "is no readable raw file (" + input->geterror() + ")",
                         "develop it to a linear 16-bit TIFF");
    check_image_size(path, spec.width, spec.height);
    if (spec.nchannels < 3) throw InputError(path, "is a raw file without colours", "develop it to a 16-bit TIFF");
    PhotographFile photograph;
    photograph.linear = true;
    photograph.code_step = 1.0 / 65535;
    photograph.exposure = recorded_exposure(spec);
    ImageF stored(spec.width, spec.height, 3);
    if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, stored.samples().data()))
        throw InputError(path, "its pixels are damaged or cut off (" + input->geterror() + ")");
    photograph.code = oriented(std::move(stored), spec.get_int_attribute("Orientation", 1));
    return photograph;
}

}  // namespace

PhotographFile read_photograph(const fs::path& path) {
    return is_raw_name(path) ? read_raw(path) : read_developed(path);
}

}  // namespace matchlight
