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

/// The encoders of this list that the FFmpeg libraries at hand have, by the names above ("h264", …).
std::vector<std::string> available_video_encoders();

struct VideoOptions {
    VideoCodec codec = VideoCodec::h264;
    std::optional<int> crf;  // h264, h265: 0 = lossless; 18 unless given
    // FFmpeg's name. Unless given the footage's own where the codec has it; R'G'B' footage becomes BT.709 yuv420p in
    // h264 and h265 and stays R'G'B' in ffv1.
    std::optional<std::string> pixel_format;
    std::string preset = "medium";
    bool copy_audio = true;
    std::string comment;  // effective scene, version and seed
};

/// Writes frames in presentation order to a video (.mp4, .mov or .mkv) beside its final name, renamed when whole.
/// Stream parameters (size, rate, matrix, range, siting, display matrix, sample aspect) and sound come from the
/// footage; the packets of its sound are copied as they are, those of the rendered span when frames are left out at
/// either end. `warnings` must outlive the sink. Throws InputError: a codec that the container or this machine does not
/// have, a full disk.
class VideoSink {
public:
    VideoSink(const std::filesystem::path& output, const FootageInfo& footage, const VideoOptions& options,
              Warnings& warnings);
    ~VideoSink();
    VideoSink(const VideoSink&) = delete;
    VideoSink& operator=(const VideoSink&) = delete;

    void write(const PlateFrame& frame);
    /// A frame of the virtual layer alone (prores4444), upright: premultiplied R'G'B'A code values, 4 floats a pixel,
    /// shown when the footage's frame `index` at `time_s` is. Not to be mixed with `write`.
    void write_rgba(const ImageF& rgba_code, std::int64_t index, double time_s);
    /// Ends the file and gives it its final name.
    void finish();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace matchlight
