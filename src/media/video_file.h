// A video file opened for demuxing: the checks before anything is decoded, its video stream, and the index of its
// packets.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "media/av_log.h"
#include "media/av_pointers.h"

namespace matchlight {

/// What the packets of the video stream say, read once without decoding.
struct PacketIndex {
    std::vector<std::int64_t> pts;  // of shown frames, ascending, in the stream's time base
    struct KeyFrame {
        std::int64_t pts = 0, dts = 0;
    };
    std::vector<KeyFrame> key_frames;   // in the order of the file
    std::int64_t packets = 0;           // of shown frames
    std::int64_t declared = 0;          // by the header; 0 where it says nothing
    bool declared_by_duration = false;  // a count reckoned from a duration is not exact
    bool ordered = true;                // every packet has a time stamp of its own, in an order that decoding keeps
    bool ran_backwards = false;
};

/// Opens a regular file of a known container, whose own names cannot make it open another. `log` must outlive it.
/// Throws InputError.
AvInput open_video_container(const std::filesystem::path& path, AvLog& log);

/// Opens regular files of known containers only: no URLs, no playlists, nothing that names other files.
class VideoFile {
public:
    /// Throws InputError.
    explicit VideoFile(const std::filesystem::path& path);

    AVFormatContext& container() { return *container_; }
    AVStream& video() { return *container_->streams[video_stream_]; }
    int video_stream() const { return video_stream_; }
    bool has_audio() const;

    /// The next packet of any stream that is not discarded; false at the end of what can be read.
    bool read(AVPacket& packet);
    /// Reads the file to its end.
    PacketIndex index_packets();
    AvLog& log() { return *log_; }

private:
    std::filesystem::path path_;
    std::unique_ptr<AvLog> log_;  // before the container, which points to it
    AvInput container_;
    int video_stream_ = -1;
};

}  // namespace matchlight
