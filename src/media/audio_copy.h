// The footage's sound, packet by packet as it is, into another file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/warnings.h"
#include "media/av_log.h"
#include "media/av_pointers.h"

namespace matchlight {

class AudioCopy {
public:
    /// Adds a stream to `output` for every sound stream that it can hold; warns of the others.
    AudioCopy(const std::filesystem::path& footage, const std::filesystem::path& reported, AVFormatContext& output,
              Warnings& warnings);

    bool empty() const { return streams_.empty(); }
    /// The part that is copied, in seconds of the footage; the output's time 0 is the footage's `shift_s`.
    void set_span(std::optional<double> begin_s, double shift_s);
    /// Writes the packets that begin before `until_s`. Returns an FFmpeg status.
    int write_until(double until_s);

private:
    struct Stream {
        int from = 0, to = 0;
    };
    bool read_packet();

    AvLog log_;
    AvInput input_;
    AVFormatContext& output_;
    std::vector<Stream> streams_;
    AvPointer<AVPacket> packet_;
    bool waiting_ = false;  // packet_ holds one that is not due yet
    std::optional<double> begin_s_;
    double shift_s_ = 0;
};

}  // namespace matchlight
