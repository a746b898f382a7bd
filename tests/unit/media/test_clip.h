// Small video files of every kind, good and bad, made at test time by FFmpeg's libraries directly.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "media/av_pointers.h"

extern "C" {
#include <libavutil/rational.h>
}

namespace matchlight {

struct TestClip {
    std::string encoder = "libx264";  // lossless unless `options` say otherwise
    std::vector<std::pair<std::string, std::string>> options = {{"qp", "0"}, {"preset", "ultrafast"}};
    AVPixelFormat pixel_format = AV_PIX_FMT_YUV420P;
    int width = 64, height = 48;
    int frames = 10;
    AVRational time_base{1, 25};
    std::vector<std::int64_t> pts;  // 0, 1, 2, … unless given
    int key_interval = 4;
    int b_frames = 2;
    int rotation_deg = 0;  // clockwise, from stored to displayed
    AVRational sample_aspect{1, 1};
    AVColorSpace matrix = AVCOL_SPC_BT709;
    AVColorRange range = AVCOL_RANGE_MPEG;
    AVColorTransferCharacteristic transfer = AVCOL_TRC_BT709;
    AVChromaLocation siting = AVCHROMA_LOC_LEFT;
    bool interlaced = false;
    bool video = true;
    std::string audio_encoder;  // none unless given
    int audio_streams = 1;
    bool header_first = true;                    // mp4, mov: moov before mdat
    std::optional<int> size_changes_at;          // from this frame on the picture is twice as wide
    std::optional<int> declared_width;           // in the container's header
    std::function<void(AVPacket&)> on_packet{};  // may change what is written
};

/// The samples of frame `index` of a clip: a moving pattern with some noise, the same on every machine.
std::shared_ptr<AVFrame> test_samples(const TestClip& clip, int index);

/// Equal size and equal samples, in whatever layout they are kept; alpha where both have it.
bool same_samples(const AVFrame& a, const AVFrame& b);

/// Writes the clip; asserts (gtest) that the libraries do their part.
void write_clip(const TestClip& clip, const std::filesystem::path& path);

/// The bytes of every packet of a kind of stream, in the order of the file, and their time stamps in seconds.
struct PacketBytes {
    int stream = 0;
    double time_s = 0;
    std::string bytes;
};
std::vector<PacketBytes> packets_of(const std::filesystem::path& path, AVMediaType type);

}  // namespace matchlight
