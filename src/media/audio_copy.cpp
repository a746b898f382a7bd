// Remuxing: time stamps are moved, bytes are not looked at.
#include "media/audio_copy.h"

#include <cmath>

#include <fmt/format.h>

#include "media/video_file.h"

namespace matchlight {

AudioCopy::AudioCopy(const std::filesystem::path& footage, const std::filesystem::path& reported,
                     AVFormatContext& output, Warnings& warnings)
    : input_(open_video_container(footage, log_)), output_(output), packet_(owned(av_packet_alloc())) {
    avformat_find_stream_info(input_.get(), nullptr);  // what it cannot find out stays as the header has it
    for (unsigned i = 0; i < input_->nb_streams; ++i) {
        AVStream& from = *input_->streams[i];
        if (from.codecpar->codec_type != AVMEDIA_TYPE_AUDIO) {
            from.discard = AVDISCARD_ALL;
            continue;
        }
        if (avformat_query_codec(output_.oformat, from.codecpar->codec_id, FF_COMPLIANCE_NORMAL) != 1) {
            from.discard = AVDISCARD_ALL;
            warnings.add(
                fmt::format("{}: its container cannot hold the footage's {} sound, which is left out; use .mkv",
                            reported.string(), avcodec_get_name(from.codecpar->codec_id)));
            continue;
        }
        AVStream* to = avformat_new_stream(&output_, nullptr);
        if (to == nullptr || avcodec_parameters_copy(to->codecpar, from.codecpar) < 0) throw std::bad_alloc();
        to->codecpar->codec_tag = 0;  // the output's container chooses its own
        to->time_base = from.time_base;
        to->disposition = from.disposition;
        av_dict_copy(&to->metadata, from.metadata, 0);
        streams_.push_back({static_cast<int>(i), to->index});
    }
}

void AudioCopy::set_span(std::optional<double> begin_s, double shift_s) {
    begin_s_ = begin_s;
    shift_s_ = shift_s;
}

bool AudioCopy::read_packet() {
    while (av_read_frame(input_.get(), packet_.get()) >= 0) {
        for (const Stream& stream : streams_) {
            if (stream.from == packet_->stream_index) return true;
        }
        av_packet_unref(packet_.get());
    }
    return false;
}

int AudioCopy::write_until(double until_s) {
    while (!streams_.empty()) {
        if (!waiting_ && !read_packet()) return 0;
        waiting_ = true;
        const AVStream& from = *input_->streams[packet_->stream_index];
        const double tick_s = av_q2d(from.time_base);
        const std::int64_t stamp = packet_->dts != AV_NOPTS_VALUE ? packet_->dts : packet_->pts;
        if (stamp != AV_NOPTS_VALUE) {
            const double begin_s = static_cast<double>(stamp) * tick_s;
            if (begin_s >= until_s) return 0;
            if (begin_s_ && begin_s + static_cast<double>(packet_->duration) * tick_s <= *begin_s_) {
                av_packet_unref(packet_.get());
                waiting_ = false;
                continue;
            }
        }
        int target = 0;
        for (const Stream& stream : streams_) {
            if (stream.from == packet_->stream_index) target = stream.to;
        }
        const AVStream& to = *output_.streams[target];
        const auto shift = static_cast<std::int64_t>(std::llround(shift_s_ / tick_s));
        if (packet_->pts != AV_NOPTS_VALUE) packet_->pts -= shift;
        if (packet_->dts != AV_NOPTS_VALUE) packet_->dts -= shift;
        av_packet_rescale_ts(packet_.get(), from.time_base, to.time_base);
        packet_->stream_index = target;
        packet_->pos = -1;
        waiting_ = false;
        const int status = av_interleaved_write_frame(&output_, packet_.get());  // takes the packet
        if (status < 0) return status;
    }
    return 0;
}

}  // namespace matchlight
