// The frames that a comparison reads: one picture, a numbered sequence or a video, as numbered pictures in order.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "core/image.h"
#include "core/warnings.h"

namespace matchlight {

/// A picture as a display shows it: 8-bit sRGB codes. Scene-linear files (EXR, Radiance) keep their light beside it.
struct ComparedFrame {
    std::int64_t number = 0;  // counted from 0 in a video; in a sequence the number of the name, less `first_number`
    std::filesystem::path file;
    Image8 rgb;
    std::optional<ImageF> linear;
};

struct ComparedFramesOptions {
    std::int64_t first_number = 0;     // the number in the names that is frame 0
    std::int64_t first = 0;            // frames before it are left out
    std::optional<std::int64_t> last;  // and those after it
    bool strict = false;               // damage of a video is an error
    bool is_mask = false;              // 1 channel, non-zero = inside; not from videos
};

class ComparedFrames {
public:
    virtual ~ComparedFrames() = default;
    /// The next frame by ascending number; nullopt at the end. Throws InputError.
    virtual std::optional<ComparedFrame> next() = 0;

    /// Throws InputError: no such file, no file of the pattern.
    static std::unique_ptr<ComparedFrames> open(const std::filesystem::path& path, const ComparedFramesOptions& options,
                                                Warnings& warnings);
};

/// Whether the path names one picture, by its extension.
bool is_single_picture(const std::filesystem::path& path);

}  // namespace matchlight
