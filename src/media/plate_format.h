// A plate's format from what a decoded frame is tagged with, and what is taken where it is not.
#pragma once

#include <filesystem>

#include "core/warnings.h"
#include "media/frame_source.h"
#include "media/plate.h"

extern "C" {
#include <libavutil/frame.h>
}

namespace matchlight {

/// Throws InputError (naming `path`) for a pixel format or matrix that is not supported.
PlateFormat plate_format_of(const AVFrame& frame, int rotation_deg, const FootageOptions& options,
                            const std::filesystem::path& path);

/// Writes matrix, range and siting of `format` into a frame's tags.
void tag_frame(const PlateFormat& format, AVFrame& frame);

}  // namespace matchlight
