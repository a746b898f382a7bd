// Footage: a video file through FFmpeg's libraries or a numbered image sequence, as one stream of plate frames.
#pragma once

#include <array>
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
    std::optional<Primaries> primaries;  // overrides the file's tags of primaries and transfer: Transfer::camera
    bool strict = false;                 // truncation and damage are errors, not warnings
};

struct Rational {
    int numerator = 0;
    int denominator = 1;
};

/// Colour tags by their numbers in ITU-T H.273; 2 = unspecified. An output is tagged as the footage was.
struct ColorTags {
    int primaries = 2;
    int transfer = 2;
    int matrix = 2;
};

struct FootageInfo {
    std::filesystem::path path;
    PlateFormat format;
    std::int64_t frame_count = 0;      // frames the file really holds, by its packets; nothing is decoded to know it
    std::int64_t declared_frames = 0;  // what its header says; 0 where it says nothing
    double fps = 0;                    // average
    bool variable_frame_rate = false;
    bool has_audio = false;
    bool is_sequence = false;
    std::int64_t first_number = 0;  // image sequences
    std::string codec;
    // What an output has to carry over.
    ColorTags tags;
    Rational time_base{1, 25};  // of the frames' pts
    Rational frame_rate{25, 1};
    Rational sample_aspect{1, 1};  // width of a pixel over its height, of the stored picture
    std::optional<std::array<std::int32_t, 9>> display_matrix;
};

/// Reads frames in presentation order.
class FrameSource {
public:
    virtual ~FrameSource() = default;
    virtual const FootageInfo& info() const = 0;
    /// The next frame; nullopt at the end. Its index counts frames in presentation order, so that a frame that could
    /// not be decoded leaves a gap. Damage is counted as warnings, or thrown as InputError when strict.
    virtual std::optional<PlateFrame> next() = 0;
    /// Makes `frame` (counted from 0) the next one; decodes from the nearest key frame before it.
    virtual void seek(std::int64_t frame) = 0;

    /// Opens a file, or a printf pattern such as "frames/%04d.jpg". Files only: no URLs, playlists, FIFOs or devices.
    /// `warnings` must outlive the source. Throws InputError.
    static std::unique_ptr<FrameSource> open(const std::filesystem::path& path, const FootageOptions& options,
                                             Warnings& warnings);
};

}  // namespace matchlight
