// Chooses between video files and image sequences.
#include "media/frame_source.h"

#include <system_error>

#include "media/image_io.h"
#include "media/sequence_source.h"
#include "media/video_source.h"

namespace matchlight {

std::unique_ptr<FrameSource> FrameSource::open(const std::filesystem::path& path, const FootageOptions& options,
                                               Warnings& warnings) {
    // A file that really has the name wins over a pattern that looks like it.
    std::error_code error;
    if (!std::filesystem::exists(path, error) && is_pattern(path))
        return std::make_unique<SequenceSource>(path, options);
    return std::make_unique<VideoSource>(path, options, warnings);
}

}  // namespace matchlight
