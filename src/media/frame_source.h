// Footage: a video file through FFmpeg's libraries or a numbered image sequence, as one stream of plate frames.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/warnings.h"
#include "media/plate.h"

namespace matchlight {

struct FootageOptions {
    std::optional<double> sequence_fps;  // image sequences only; 25 unless given
    std::optional<ColorMatrix> matrix;   // overrides the file's tag
    std::optional<ColorRange> range;
    bool strict = false;  // truncation and damage are errors, not warnings
};

struct FootageInfo {
    std::filesystem::path path;
    PlateFormat format;
    std::int64_t declared_frames = 0;  // 0 where the file does not say
    double fps = 0;                    // average
    bool variable_frame_rate = false;
    bool has_audio = false;
    bool is_sequence = false;
    std::int64_t first_number = 0;  // image sequences
    std::string codec;
};

/// Reads frames in presentation order.
class FrameSource {
public:
    virtual ~FrameSource() = default;
    virtual const FootageInfo& info() const = 0;
    /// The next frame; nullopt at the end. Damage is counted as warnings, or thrown as InputError when strict.
    virtual std::optional<PlateFrame> next() = 0;
    /// Makes `frame` (counted from 0) the next one; decodes from the nearest key frame before it.
    virtual void seek(std::int64_t frame) = 0;

    /// Opens a file, or a printf pattern such as "frames/%04d.jpg". Files only: no URLs, playlists, FIFOs or devices.
    /// Throws InputError.
    static std::unique_ptr<FrameSource> open(const std::filesystem::path& path, const FootageOptions& options,
                                             Warnings& warnings);
};

}  // namespace matchlight
