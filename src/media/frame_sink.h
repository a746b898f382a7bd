// Output: a video file that keeps the footage's samples, time stamps and sound, or a numbered image sequence.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/warnings.h"
#include "media/frame_source.h"
#include "media/plate.h"

namespace matchlight {

enum class VideoCodec { h264, h265, ffv1, prores4444 };
std::optional<VideoCodec> video_codec_from_name(const std::string& name);

struct VideoOptions {
    VideoCodec codec = VideoCodec::h264;
    std::optional<int> crf;                   // h264, h265; 0 = lossless
    std::optional<std::string> pixel_format;  // the footage's own unless given
    std::string preset = "medium";
    bool copy_audio = true;
    std::string comment;  // effective scene, version and seed
};

/// Writes frames in presentation order to a video beside its final name, renamed when whole. Stream parameters (size,
/// rate, matrix, range, siting, display matrix, sample aspect) and sound come from the footage. Throws InputError.
class VideoSink {
public:
    VideoSink(const std::filesystem::path& output, const FootageInfo& footage, const VideoOptions& options,
              Warnings& warnings);
    ~VideoSink();
    VideoSink(const VideoSink&) = delete;
    VideoSink& operator=(const VideoSink&) = delete;

    void write(const PlateFrame& frame);
    /// A frame of the virtual layer alone (prores4444): premultiplied R'G'B'A code values, 4 floats a pixel.
    void write_rgba(const ImageF& rgba_code, std::int64_t index, double time_s);
    /// Ends the file and gives it its final name. `last_time_s` bounds the copied sound when fewer frames were
    /// rendered.
    void finish();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace matchlight
