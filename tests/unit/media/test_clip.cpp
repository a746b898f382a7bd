// Encodes and muxes without Matchlight's own sink, so that source and sink are tested against something else.
#include "test_clip.h"

#include <cmath>

#include <gtest/gtest.h>

#include "media/sample_layout.h"

extern "C" {
#include <libavutil/channel_layout.h>
#include <libavutil/display.h>
#include <libavutil/opt.h>
}

#if defined(__SANITIZE_ADDRESS__)
// x265 3.5 does not free all that an encoder allocated; what is ours is still looked for.
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libx265";
}
#endif

namespace matchlight {

namespace {

struct Track {
    AvPointer<AVCodecContext> encoder;
    AVStream* stream = nullptr;
};

void must(int status, const char* what) {
    ASSERT_GE(status, 0) << what << ": " << status;
}

AvPointer<AVCodecContext> open_video(const TestClip& clip, int width, bool global_header) {
    const AVCodec* codec = avcodec_find_encoder_by_name(clip.encoder.c_str());
    EXPECT_NE(codec, nullptr) << clip.encoder;
    AvPointer<AVCodecContext> encoder = owned(avcodec_alloc_context3(codec));
    encoder->width = width;
    encoder->height = clip.height;
    encoder->pix_fmt = clip.pixel_format;
    encoder->time_base = clip.time_base;
    encoder->framerate = av_inv_q(clip.time_base);
    encoder->sample_aspect_ratio = clip.sample_aspect;
    encoder->colorspace = clip.matrix;
    encoder->color_range = clip.range;
    encoder->color_trc = clip.transfer;
    encoder->color_primaries = AVCOL_PRI_BT709;
    encoder->chroma_sample_location = clip.siting;
    encoder->gop_size = clip.key_interval;
    encoder->max_b_frames = clip.b_frames;
    encoder->thread_count = 1;
    encoder->strict_std_compliance = FF_COMPLIANCE_EXPERIMENTAL;
    if (clip.interlaced) encoder->flags |= AV_CODEC_FLAG_INTERLACED_DCT | AV_CODEC_FLAG_INTERLACED_ME;
    if (global_header) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    for (const auto& [key, value] : clip.options)
        must(av_opt_set(encoder.get(), key.c_str(), value.c_str(), AV_OPT_SEARCH_CHILDREN), key.c_str());
    must(avcodec_open2(encoder.get(), codec, nullptr), "open encoder");
    return encoder;
}

AvPointer<AVCodecContext> open_audio(const TestClip& clip, bool global_header) {
    const AVCodec* codec = avcodec_find_encoder_by_name(clip.audio_encoder.c_str());
    EXPECT_NE(codec, nullptr) << clip.audio_encoder;
    AvPointer<AVCodecContext> encoder = owned(avcodec_alloc_context3(codec));
    encoder->sample_fmt = codec->sample_fmts[0];
    encoder->sample_rate = 48000;
    av_channel_layout_default(&encoder->ch_layout, 1);
    encoder->time_base = {1, encoder->sample_rate};
    if (global_header) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    must(avcodec_open2(encoder.get(), codec, nullptr), "open sound encoder");
    return encoder;
}

void mux(AVFormatContext& container, AVCodecContext& encoder, AVStream& stream, const AVFrame* frame,
         const TestClip& clip) {
    must(avcodec_send_frame(&encoder, frame), "send frame");
    const AvPointer<AVPacket> packet = owned(av_packet_alloc());
    while (avcodec_receive_packet(&encoder, packet.get()) >= 0) {
        packet->stream_index = stream.index;
        const bool video = stream.codecpar->codec_type == AVMEDIA_TYPE_VIDEO;
        if (video && packet->duration == 0) packet->duration = 1;
        if (video && clip.on_packet) clip.on_packet(*packet);
        av_packet_rescale_ts(packet.get(), encoder.time_base, stream.time_base);
        must(av_interleaved_write_frame(&container, packet.get()), "write packet");
    }
}

/// A second of sound is 440 Hz with a slow swell, in whatever sample format the encoder has.
AvPointer<AVFrame> tone(const AVCodecContext& encoder, std::int64_t start, int samples) {
    AvPointer<AVFrame> frame = owned(av_frame_alloc());
    frame->nb_samples = samples;
    frame->format = encoder.sample_fmt;
    frame->sample_rate = encoder.sample_rate;
    av_channel_layout_copy(&frame->ch_layout, &encoder.ch_layout);
    must(av_frame_get_buffer(frame.get(), 0), "sound buffer");
    frame->pts = start;
    for (int i = 0; i < samples; ++i) {
        const double t = static_cast<double>(start + i) / encoder.sample_rate;
        const double value = 0.4 * std::sin(2764.6 * t) * (0.5 + 0.5 * std::sin(5 * t));
        if (encoder.sample_fmt == AV_SAMPLE_FMT_FLTP) {
            reinterpret_cast<float*>(frame->data[0])[i] = static_cast<float>(value);
        } else {
            EXPECT_EQ(encoder.sample_fmt, AV_SAMPLE_FMT_S16);
            reinterpret_cast<std::int16_t*>(frame->data[0])[i] = static_cast<std::int16_t>(value * 32767);
        }
    }
    return frame;
}

void write_audio(const TestClip& clip, AVFormatContext& container, std::vector<Track>& tracks, double until_s,
                 std::vector<std::int64_t>& written) {
    for (std::size_t i = 0; i < tracks.size(); ++i) {
        AVCodecContext& encoder = *tracks[i].encoder;
        const int samples = encoder.frame_size > 0 ? encoder.frame_size : 1024;
        while (static_cast<double>(written[i]) / encoder.sample_rate < until_s) {
            const AvPointer<AVFrame> frame = tone(encoder, written[i], samples);
            mux(container, encoder, *tracks[i].stream, frame.get(), clip);
            written[i] += samples;
        }
    }
}

}  // namespace

std::shared_ptr<AVFrame> test_samples(const TestClip& clip, int index) {
    const bool wide = clip.size_changes_at && index >= *clip.size_changes_at;
    std::shared_ptr<AVFrame> frame = allocated_frame(clip.width * (wide ? 2 : 1), clip.height, clip.pixel_format);
    const SampleLayout layout = *SampleLayout::of(clip.pixel_format);
    std::uint32_t state = 12345u + static_cast<std::uint32_t>(index);
    for (int c = 0; c < layout.colours + (layout.has_alpha ? 1 : 0); ++c) {
        const int most = layout.component[static_cast<std::size_t>(c)].max();
        for (int y = 0; y < layout.height_of(c, *frame); ++y) {
            for (int x = 0; x < layout.width_of(c, *frame); ++x) {
                state = state * 1664525u + 1013904223u;
                const double wave = 0.5 + 0.3 * std::sin(0.2 * x + 0.3 * index + c) * std::cos(0.15 * y);
                const double noise = 0.05 * (static_cast<double>(state >> 8) / (1 << 24) - 0.5);
                write_sample(layout, *frame, c, x, y, static_cast<int>((wave + noise) * most));
            }
        }
    }
    frame->colorspace = clip.matrix;
    frame->color_range = clip.range;
    frame->color_trc = clip.transfer;
    frame->color_primaries = AVCOL_PRI_BT709;
    frame->chroma_location = clip.siting;
    frame->sample_aspect_ratio = clip.sample_aspect;
    frame->interlaced_frame = clip.interlaced ? 1 : 0;
    frame->top_field_first = clip.interlaced ? 1 : 0;
    frame->pts = clip.pts.empty() ? index : clip.pts[static_cast<std::size_t>(index)];
    return frame;
}

bool same_samples(const AVFrame& a, const AVFrame& b) {
    const SampleLayout la = *SampleLayout::of(static_cast<AVPixelFormat>(a.format));
    const SampleLayout lb = *SampleLayout::of(static_cast<AVPixelFormat>(b.format));
    if (!la.same_colours(lb) || a.width != b.width || a.height != b.height) return false;
    std::vector<std::uint16_t> ra(static_cast<std::size_t>(a.width)), rb(ra.size());
    for (int c = 0; c < la.colours + (la.has_alpha && lb.has_alpha ? 1 : 0); ++c) {
        for (int y = 0; y < la.height_of(c, a); ++y) {
            read_samples(la, a, {c, 0, y, la.width_of(c, a)}, ra.data());
            read_samples(lb, b, {c, 0, y, la.width_of(c, a)}, rb.data());
            if (!std::equal(ra.begin(), ra.begin() + la.width_of(c, a), rb.begin())) return false;
        }
    }
    return true;
}

void write_clip(const TestClip& clip, const std::filesystem::path& path) {
    av_log_set_level(AV_LOG_QUIET);
    AVFormatContext* container = nullptr;
    must(avformat_alloc_output_context2(&container, nullptr, nullptr, path.c_str()), "container");
    const bool global_header = (container->oformat->flags & AVFMT_GLOBALHEADER) != 0;
    Track video;
    AvPointer<AVCodecContext> wide;
    if (clip.video) {
        video.encoder = open_video(clip, clip.width, global_header);
        video.stream = avformat_new_stream(container, nullptr);
        must(avcodec_parameters_from_context(video.stream->codecpar, video.encoder.get()), "parameters");
        if (clip.declared_width) video.stream->codecpar->width = *clip.declared_width;
        video.stream->time_base = clip.time_base;
        video.stream->sample_aspect_ratio = clip.sample_aspect;
        if (clip.rotation_deg != 0) {
            auto* matrix = reinterpret_cast<std::int32_t*>(
                av_stream_new_side_data(video.stream, AV_PKT_DATA_DISPLAYMATRIX, 9 * sizeof(std::int32_t)));
            av_display_rotation_set(matrix, clip.rotation_deg);  // this function turns clockwise
        }
        if (clip.size_changes_at) wide = open_video(clip, clip.width * 2, global_header);
    }
    std::vector<Track> audio;
    for (int i = 0; !clip.audio_encoder.empty() && i < clip.audio_streams; ++i) {
        Track track{open_audio(clip, global_header), avformat_new_stream(container, nullptr)};
        must(avcodec_parameters_from_context(track.stream->codecpar, track.encoder.get()), "parameters");
        track.stream->time_base = track.encoder->time_base;
        audio.push_back(std::move(track));
    }
    AVDictionary* options = nullptr;
    if (clip.header_first) av_dict_set(&options, "movflags", "+faststart", 0);
    must(avio_open(&container->pb, path.c_str(), AVIO_FLAG_WRITE), "open");
    must(avformat_write_header(container, &options), "header");
    av_dict_free(&options);

    std::vector<std::int64_t> written(audio.size(), 0);
    const double length_s = clip.frames * av_q2d(clip.time_base);
    if (clip.video) {
        for (int i = 0; i < clip.frames; ++i) {
            const std::shared_ptr<AVFrame> frame = test_samples(clip, i);
            AVCodecContext& encoder = clip.size_changes_at && i >= *clip.size_changes_at ? *wide : *video.encoder;
            mux(*container, encoder, *video.stream, frame.get(), clip);
            write_audio(clip, *container, audio, static_cast<double>(frame->pts) * av_q2d(clip.time_base), written);
        }
        mux(*container, *video.encoder, *video.stream, nullptr, clip);
    }
    write_audio(clip, *container, audio, length_s, written);
    for (Track& track : audio) mux(*container, *track.encoder, *track.stream, nullptr, clip);
    must(av_write_trailer(container), "trailer");
    avio_closep(&container->pb);
    avformat_free_context(container);
}

std::vector<PacketBytes> packets_of(const std::filesystem::path& path, AVMediaType type) {
    AVFormatContext* context = nullptr;
    EXPECT_GE(avformat_open_input(&context, path.c_str(), nullptr, nullptr), 0) << path;
    const AvInput input(context);
    EXPECT_GE(avformat_find_stream_info(context, nullptr), 0);
    std::vector<PacketBytes> packets;
    const AvPointer<AVPacket> packet = owned(av_packet_alloc());
    while (av_read_frame(context, packet.get()) >= 0) {
        const AVStream& stream = *context->streams[packet->stream_index];
        if (stream.codecpar->codec_type == type)
            packets.push_back(
                {packet->stream_index, static_cast<double>(packet->pts) * av_q2d(stream.time_base),
                 std::string(reinterpret_cast<const char*>(packet->data), static_cast<std::size_t>(packet->size))});
        av_packet_unref(packet.get());
    }
    return packets;
}

}  // namespace matchlight
