// Encoding and muxing through FFmpeg's libraries; every status is looked at, so that a full disk is found out.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <system_error>

#include <fmt/format.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/lowercase.h"
#include "media/audio_copy.h"
#include "media/av_log.h"
#include "media/av_pointers.h"
#include "media/frame_conversion.h"
#include "media/frame_sink.h"
#include "media/plate_format.h"

extern "C" {
#include <libavutil/opt.h>
}

namespace matchlight {

namespace {

namespace fs = std::filesystem;

struct CodecEntry {
    VideoCodec codec;
    const char* name;     // in scene files
    const char* encoder;  // in libavcodec
};
constexpr std::array<CodecEntry, 4> codec_table = {{{VideoCodec::h264, "h264", "libx264"},
                                                    {VideoCodec::h265, "h265", "libx265"},
                                                    {VideoCodec::ffv1, "ffv1", "ffv1"},
                                                    {VideoCodec::prores4444, "prores4444", "prores_ks"}}};

const CodecEntry& entry_of(VideoCodec codec) {
    return *std::find_if(codec_table.begin(), codec_table.end(), [&](const CodecEntry& e) { return e.codec == codec; });
}

const AVCodec& find_encoder(const fs::path& output, VideoCodec codec) {
    AvLog::install();
    const CodecEntry& entry = entry_of(codec);
    const AVCodec* encoder = avcodec_find_encoder_by_name(entry.encoder);
    if (encoder == nullptr)
        throw InputError(output,
                         fmt::format("the FFmpeg libraries here have no {} encoder ({})", entry.name, entry.encoder),
                         "see `matchlight doctor`");
    return *encoder;
}

// Visually lossless for x264 and x265 at their usual presets; their own default of 23 and 28 blurs grain.
constexpr int default_crf = 18;

struct OutputCloser {
    void operator()(AVFormatContext* context) const {
        avio_closep(&context->pb);
        avformat_free_context(context);
    }
};

AVRational av_rational(const Rational& value) {
    return {value.numerator, value.denominator};
}

}  // namespace

std::optional<VideoCodec> video_codec_from_name(const std::string& name) {
    for (const CodecEntry& entry : codec_table) {
        if (name == entry.name) return entry.codec;
    }
    return std::nullopt;
}

std::vector<std::string> available_video_encoders() {
    std::vector<std::string> names;
    for (const CodecEntry& entry : codec_table) {
        if (avcodec_find_encoder_by_name(entry.encoder) != nullptr) names.emplace_back(entry.name);
    }
    return names;
}

struct VideoSink::Impl {
    Impl(const fs::path& output, const FootageInfo& footage_info, const VideoOptions& video_options,
         Warnings& warning_list)
        : options(video_options),
          footage(footage_info),
          warnings(warning_list),
          encoder_type(find_encoder(output, video_options.codec)),
          conversion(footage_info.format, encoder_type, video_options, output, warning_list),
          pending(output),
          packet(owned(av_packet_alloc())) {
        open_container();
        if (options.copy_audio && footage.has_audio)
            audio = std::make_unique<AudioCopy>(footage.path, pending.final_path(), *container, warnings);
    }

    void open_container();
    void open_encoder(const PlateFormat& format, AVPixelFormat pixel_format, bool layer);
    void set_codec_options();
    void begin(const PlateFormat& format, AVPixelFormat pixel_format, bool layer, std::int64_t index, std::int64_t pts);
    void encode(AVFrame& frame, std::int64_t index);
    void receive_packets();
    void end();
    void check(int status, const char* what) const;
    double seconds(std::int64_t pts) const { return static_cast<double>(pts) * av_q2d(av_rational(footage.time_base)); }

    VideoOptions options;
    FootageInfo footage;
    Warnings& warnings;
    const AVCodec& encoder_type;
    FrameConversion conversion;
    PendingFile pending;
    AvLog log;
    std::unique_ptr<AVFormatContext, OutputCloser> container;
    AvPointer<AVCodecContext> encoder;
    AvPointer<AVPacket> packet;
    AVStream* stream = nullptr;
    std::unique_ptr<AudioCopy> audio;
    std::map<std::int64_t, std::int64_t> duration_at;  // of frames inside the encoder, by pts
    std::int64_t shift = 0;                            // pts that becomes 0
    std::int64_t last_index = -1;
    std::int64_t end_pts = 0;  // when the last frame stops being shown
};

void VideoSink::Impl::check(int status, const char* what) const {
    if (status >= 0) return;
    InputErrorParts parts;
    parts.file = pending.final_path();
    parts.cause = std::string(what) + ": " + av_error_text(status);
    if (last_index >= 0) parts.frame = last_index;
    if (status == AVERROR(ENOSPC) || status == AVERROR(EFBIG) || status == AVERROR(EDQUOT))
        parts.cure = "free some space on the disk";
    throw InputError(parts);
}

void VideoSink::Impl::open_container() {
    const fs::path& output = pending.final_path();
    const std::string extension = lowercase_extension(output);
    if (extension != ".mp4" && extension != ".mov" && extension != ".mkv")
        throw InputError(output, fmt::format("\"{}\" names no video container", extension), "use .mp4, .mov or .mkv");
    AVFormatContext* context = nullptr;
    const std::string url = "file:" + pending.path().string();
    check(avformat_alloc_output_context2(&context, nullptr, nullptr, url.c_str()), "cannot be opened");
    container.reset(context);
    container->opaque = &log;
    // No random identifiers and no dates: the same frames give the same file.
    container->flags |= AVFMT_FLAG_BITEXACT;
    if (avformat_query_codec(container->oformat, encoder_type.id, FF_COMPLIANCE_NORMAL) != 1)
        throw InputError(output, fmt::format("{} cannot be stored in {}", entry_of(options.codec).name, extension),
                         options.codec == VideoCodec::ffv1 ? "use .mkv" : "use .mov or .mkv");
    if (extension == ".mkv" && footage.format.rotation_deg != 0)
        throw InputError(output, "Matroska cannot carry the footage's rotation", "use .mp4 or .mov");
    if (!options.comment.empty()) av_dict_set(&container->metadata, "comment", options.comment.c_str(), 0);
    check(avio_open(&container->pb, url.c_str(), AVIO_FLAG_WRITE), "cannot be created");
    stream = avformat_new_stream(container.get(), nullptr);
    if (stream == nullptr) throw std::bad_alloc();
}

void VideoSink::Impl::set_codec_options() {
    void* own = encoder->priv_data;
    const int crf = options.crf.value_or(default_crf);
    if (crf < 0 || crf > 51)
        throw InputError(pending.final_path(), fmt::format("crf {} is out of range", crf), "use 0 (lossless) to 51");
    switch (options.codec) {
        case VideoCodec::h264:
            check(av_opt_set(own, "preset", options.preset.c_str(), 0), "preset");
            // At 10 bits crf 0 is not lossless in x264, qp 0 always is.
            check(av_opt_set_int(own, crf == 0 ? "qp" : "crf", crf, 0), "crf");
            // x264's macroblock tree works on rows of eight macroblocks at a time and reads past the end of others, so
            // that its choices hang on leftover memory (build 164, measured: files differ from run to run).
            if ((encoder->width + 15) / 16 % 8 != 0) check(av_opt_set_int(own, "mbtree", 0, 0), "mbtree");
            break;
        case VideoCodec::h265: {
            check(av_opt_set(own, "preset", options.preset.c_str(), 0), "preset");
            check(av_opt_set_double(own, "crf", crf, 0), "crf");
            // x265 prints by itself, past FFmpeg's log.
            const std::string parameters = std::string("log-level=none") + (crf == 0 ? ":lossless=1" : "");
            check(av_opt_set(own, "x265-params", parameters.c_str(), 0), "x265-params");
            if (container->oformat->codec_tag != nullptr && std::string(container->oformat->name) != "matroska")
                encoder->codec_tag = MKTAG('h', 'v', 'c', '1');  // what QuickTime players look for
            break;
        }
        case VideoCodec::ffv1:
            encoder->level = 3;  // slices with checksums, so that damage is found
            encoder->gop_size = 1;
            check(av_opt_set_int(own, "slicecrc", 1, 0), "slicecrc");
            break;
        case VideoCodec::prores4444:
            check(av_opt_set(own, "profile", "4444", 0), "profile");
            check(av_opt_set(own, "vendor", "apl0", 0), "vendor");
            break;
    }
}

void VideoSink::Impl::open_encoder(const PlateFormat& format, AVPixelFormat pixel_format, bool layer) {
    encoder = owned(avcodec_alloc_context3(&encoder_type));
    encoder->opaque = &log;
    encoder->width = format.width;
    encoder->height = format.height;
    encoder->pix_fmt = pixel_format;
    encoder->time_base = av_rational(footage.time_base);
    encoder->framerate = av_rational(footage.frame_rate);
    encoder->sample_aspect_ratio = stream->sample_aspect_ratio = av_rational(footage.sample_aspect);
    encoder->color_primaries = static_cast<AVColorPrimaries>(footage.tags.primaries);
    encoder->color_trc = static_cast<AVColorTransferCharacteristic>(footage.tags.transfer);
    // Samples that stay keep the footage's tag, absent or not: a player guesses as it did before.
    const bool same_matrix = !layer && format.matrix == footage.format.matrix;
    encoder->colorspace = static_cast<AVColorSpace>(same_matrix ? footage.tags.matrix : matrix_tag(format.matrix));
    encoder->color_range = format.range == ColorRange::full ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
    encoder->chroma_sample_location = siting_tag(format);
    encoder->thread_count = 0;
    if ((container->oformat->flags & AVFMT_GLOBALHEADER) != 0) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    set_codec_options();
    const int status = avcodec_open2(encoder.get(), &encoder_type, nullptr);
    if (status < 0)
        throw InputError(
            pending.final_path(),
            fmt::format("the {} encoder refuses {}x{} {} ({}){}", entry_of(options.codec).name, format.width,
                        format.height, format.pixel_format, av_error_text(status), log.take_cause()));
}

void VideoSink::Impl::begin(const PlateFormat& format, AVPixelFormat pixel_format, bool layer, std::int64_t index,
                            std::int64_t pts) {
    open_encoder(format, pixel_format, layer);
    check(avcodec_parameters_from_context(stream->codecpar, encoder.get()), "cannot be described");
    stream->time_base = encoder->time_base;
    stream->avg_frame_rate = encoder->framerate;
    if (footage.display_matrix && !layer && footage.format.rotation_deg != 0) {
        std::uint8_t* data =
            av_stream_new_side_data(stream, AV_PKT_DATA_DISPLAYMATRIX, sizeof(*footage.display_matrix));
        if (data == nullptr) throw std::bad_alloc();
        std::copy_n(reinterpret_cast<const std::uint8_t*>(footage.display_matrix->data()),
                    sizeof(*footage.display_matrix), data);
    }
    // A whole clip keeps its time stamps, and with them the offset between picture and sound.
    shift = index == 0 ? 0 : pts;
    if (audio) audio->set_span(index == 0 ? std::nullopt : std::optional(seconds(pts)), seconds(shift));

    AVDictionary* muxer_options = nullptr;
    if (footage.time_base.numerator == 1)  // QuickTime containers then keep time stamps exactly
        av_dict_set_int(&muxer_options, "video_track_timescale", footage.time_base.denominator, 0);
    const int status = avformat_write_header(container.get(), &muxer_options);
    av_dict_free(&muxer_options);
    check(status, "its header cannot be written");
}

void VideoSink::Impl::encode(AVFrame& frame, std::int64_t index) {
    if (audio) check(audio->write_until(seconds(frame.pts)), "the sound cannot be written");
    last_index = index;
    end_pts = frame.pts + std::max<std::int64_t>(1, frame.pkt_duration);
    duration_at[frame.pts - shift] = std::max<std::int64_t>(1, frame.pkt_duration);
    frame.pts -= shift;
    frame.pict_type = AV_PICTURE_TYPE_NONE;  // the encoder chooses, not the footage's
    frame.key_frame = 0;
    // ProRes takes its tags from the frames.
    frame.color_primaries = encoder->color_primaries;
    frame.color_trc = encoder->color_trc;
    frame.colorspace = encoder->colorspace;
    frame.color_range = encoder->color_range;
    frame.chroma_location = encoder->chroma_sample_location;
    check(avcodec_send_frame(encoder.get(), &frame), "cannot be encoded");
    receive_packets();
}

void VideoSink::Impl::receive_packets() {
    while (true) {
        const int status = avcodec_receive_packet(encoder.get(), packet.get());
        if (status == AVERROR(EAGAIN) || status == AVERROR_EOF) return;
        check(status, "cannot be encoded");
        const auto duration = duration_at.find(packet->pts);
        if (duration != duration_at.end()) {
            packet->duration = duration->second;
            duration_at.erase(duration);
        }
        av_packet_rescale_ts(packet.get(), encoder->time_base, stream->time_base);
        packet->stream_index = stream->index;
        check(av_interleaved_write_frame(container.get(), packet.get()), "cannot be written");
    }
}

void VideoSink::Impl::end() {
    if (!encoder) throw InputError(pending.final_path(), "no frame was rendered", "check the range of frames");
    check(avcodec_send_frame(encoder.get(), nullptr), "cannot be encoded");
    receive_packets();
    const bool to_the_end = last_index + 1 >= footage.frame_count;
    if (audio)
        check(audio->write_until(to_the_end ? std::numeric_limits<double>::infinity() : seconds(end_pts)),
              "the sound cannot be written");
    check(av_write_trailer(container.get()), "its end cannot be written");
    const std::int64_t size = avio_size(container->pb);
    check(avio_closep(&container->pb), "cannot be closed");
    std::error_code error;
    const std::uintmax_t written = fs::file_size(pending.path(), error);
    if (error || size < 0 || written != static_cast<std::uintmax_t>(size))
        throw InputError(pending.final_path(), last_index, "is shorter on the disk than what was written",
                         "free some space on the disk");
    pending.commit();
}

VideoSink::VideoSink(const fs::path& output, const FootageInfo& footage, const VideoOptions& options,
                     Warnings& warnings)
    : impl_(std::make_unique<Impl>(output, footage, options, warnings)) {}

VideoSink::~VideoSink() = default;

void VideoSink::write(const PlateFrame& frame) {
    std::shared_ptr<AVFrame> samples = impl_->conversion(frame);
    samples->pts = frame.samples()->pts;
    samples->pkt_duration = frame.samples()->pkt_duration;
    if (!impl_->encoder)
        impl_->begin(impl_->conversion.encoded(), impl_->conversion.pixel_format(), false, frame.index(), samples->pts);
    impl_->encode(*samples, frame.index());
}

void VideoSink::write_rgba(const ImageF& rgba_code, std::int64_t index, double time_s) {
    assert(impl_->options.codec == VideoCodec::prores4444);
    PlateFormat layer;
    layer.width = rgba_code.width();
    layer.height = rgba_code.height();
    layer.bit_depth = 10;
    layer.has_alpha = true;
    layer.pixel_format = "yuva444p10le";
    std::shared_ptr<AVFrame> frame = frame_from_rgba(rgba_code, AV_PIX_FMT_YUVA444P10LE, layer);
    const double tick_s = impl_->seconds(1);
    frame->pts = std::llround(time_s / tick_s);
    frame->pkt_duration = std::max<std::int64_t>(1, std::llround(1 / (impl_->footage.fps * tick_s)));
    if (!impl_->encoder) impl_->begin(layer, AV_PIX_FMT_YUVA444P10LE, true, index, frame->pts);
    impl_->encode(*frame, index);
}

void VideoSink::finish() {
    impl_->end();
}

}  // namespace matchlight
