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

/// H.273's number of a matrix.
int matrix_tag(ColorMatrix matrix);
/// FFmpeg's tag of the siting; unspecified where chroma is not subsampled.
AVChromaLocation siting_tag(const PlateFormat& format);

}  // namespace matchlight
