// Recognises a still image by its first bytes: extensions lie, and trying every reader would wake video demuxers.
#pragma once

#include <filesystem>

namespace matchlight {

enum class PictureFormat { png, jpeg, tiff, bmp, pnm, targa, webp, radiance, exr };

/// Throws InputError when the file is missing, empty, no regular file or of no known format.
PictureFormat recognise_picture(const std::filesystem::path& path);

/// Throws InputError when a PNG or JPEG file is cut off or its chunks are damaged, which their libraries would hide or
/// print on standard error.
void require_whole_picture(const std::filesystem::path& path, PictureFormat format);

}  // namespace matchlight
