// Frames of a video file through libavcodec.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "media/frame_source.h"
#include "media/video_file.h"

namespace matchlight {

class VideoSource : public FrameSource {
public:
    VideoSource(const std::filesystem::path& path, const FootageOptions& options, Warnings& warnings);

    const FootageInfo& info() const override { return info_; }
    std::optional<PlateFrame> next() override;
    void seek(std::int64_t frame) override;

private:
    void open_file();
    void open_decoder();
    void read_index();
    void describe(const PlateFrame& first);
    void describe_rate();
    /// The next decoded frame in the decoder's order; null at the end.
    std::shared_ptr<AVFrame> decode();
    void feed();
    std::optional<PlateFrame> decode_plate();
    void place_in_time(AVFrame& frame);
    void check_unchanged(const AVFrame& frame) const;
    void note_condition(const AVFrame& frame);
    void damaged(const std::string& cause);
    void count_missing();
    void restart();
    bool position_before(std::int64_t frame);

    std::filesystem::path path_;
    FootageOptions options_;
    Warnings& warnings_;
    FootageInfo info_;
    std::unique_ptr<VideoFile> file_;
    AvLog decoder_log_;  // before the decoder, which points to it
    AvPointer<AVCodecContext> decoder_;
    AvPointer<AVPacket> packet_;
    PacketIndex index_;
    int rotation_deg_ = 0;
    bool draining_ = false;
    std::int64_t next_index_ = 0;   // of the frame that decode_plate() gives next
    std::int64_t seek_target_ = 0;  // frames before it are passed over
    std::int64_t first_pts_ = 0, last_pts_ = 0;
    bool has_last_pts_ = false;
    bool whole_run_ = true;  // no seek so far: what is missing at the end can be counted
    std::int64_t decoded_ = 0;
    std::optional<PlateFrame> ready_;  // decoded ahead
    // The stored format of the first frame, which all others must have.
    int stored_width_ = 0, stored_height_ = 0, stored_format_ = -1;
};

}  // namespace matchlight
