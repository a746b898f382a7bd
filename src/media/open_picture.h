// A picture file opened by the reader that its first bytes ask for, its header checked.
#pragma once

#include <filesystem>
#include <memory>

#include <OpenImageIO/imageio.h>

namespace matchlight {

struct OpenPicture {
    std::unique_ptr<OIIO::ImageInput> input;
    OIIO::ImageSpec spec;
    int orientation = 1;  // EXIF
};

/// Throws InputError.
OpenPicture open_picture(const std::filesystem::path& path);

}  // namespace matchlight
