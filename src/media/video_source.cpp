// Decoding: every status is looked at, because the libraries report success on cut and damaged files.
#include "media/video_source.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "media/input_limits.h"
#include "media/plate_format.h"
#include "media/sample_layout.h"

extern "C" {
#include <libavutil/display.h>
#include <libavutil/pixdesc.h>
}

namespace matchlight {

namespace {

namespace fs = std::filesystem;

constexpr char export_again[] = "export or copy it again";

/// The clockwise turn from stored to displayed, and the matrix as it stands in the file.
struct Display {
    int rotation_deg = 0;
    std::optional<std::array<std::int32_t, 9>> matrix;
};

Display display_of(AVStream& stream, const fs::path& path, Warnings& warnings) {
    Display display;
    std::size_t bytes = 0;
    const std::uint8_t* data = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, &bytes);
    if (data == nullptr || bytes != 9 * sizeof(std::int32_t)) return display;
    std::array<std::int32_t, 9> matrix{};
    std::copy_n(data, bytes, reinterpret_cast<std::uint8_t*>(matrix.data()));
    display.matrix = matrix;
    const double clockwise_deg = -av_display_rotation_get(matrix.data());
    const bool mirrored = std::int64_t{matrix[0]} * matrix[4] - std::int64_t{matrix[1]} * matrix[3] < 0;
    const double quarter = std::round(clockwise_deg / 90);
    if (!std::isfinite(clockwise_deg) || mirrored || std::abs(clockwise_deg - 90 * quarter) > 0.5) {
        warnings.add(path.string() + ": its display matrix is no quarter turn and is ignored");
        return {};
    }
    display.rotation_deg = ((static_cast<int>(quarter) % 4) + 4) % 4 * 90;
    return display;
}

/// Palette entries are 0xAARRGGBB words; as B G R A samples nothing is lost.
std::shared_ptr<AVFrame> without_palette(const AVFrame& indexed) {
    AvPointer<AVFrame> frame = allocated_frame(indexed.width, indexed.height, AV_PIX_FMT_BGRA);
    if (av_frame_copy_props(frame.get(), &indexed) < 0) throw std::bad_alloc();
    for (int y = 0; y < indexed.height; ++y) {
        const std::uint8_t* from = indexed.data[0] + static_cast<std::ptrdiff_t>(y) * indexed.linesize[0];
        std::uint8_t* to = frame->data[0] + static_cast<std::ptrdiff_t>(y) * frame->linesize[0];
        for (int x = 0; x < indexed.width; ++x) std::copy_n(indexed.data[1] + 4 * from[x], 4, to + 4 * x);
    }
    return std::shared_ptr<AVFrame>(std::move(frame));
}

Rational rational(AVRational value) {
    return {value.num, value.den};
}

}  // namespace

VideoSource::VideoSource(const fs::path& path, const FootageOptions& options, Warnings& warnings)
    : path_(path), options_(options), warnings_(warnings), packet_(owned(av_packet_alloc())) {
    open_file();
    const Display display = display_of(file_->video(), path_, warnings_);
    rotation_deg_ = display.rotation_deg;
    info_.display_matrix = display.matrix;
    read_index();
    restart();
    ready_ = decode_plate();
    if (!ready_) throw InputError(path_, "no frame of it can be decoded" + decoder_log_.take_cause(), export_again);
    describe(*ready_);
}

void VideoSource::open_file() {
    decoder_.reset();
    file_ = std::make_unique<VideoFile>(path_);
}

void VideoSource::read_index() {
    index_ = file_->index_packets();
    if (index_.packets == 0) throw InputError(path_, "holds no frames", export_again);
    const std::string name = path_.string();
    if (index_.ran_backwards)
        warnings_.add(name + ": its time stamps run backwards or repeat; frames keep the order of the file");
    if (index_.declared == 0) return;
    // A duration that ends within two frames of the last one is the same duration rounded.
    const std::int64_t slack = index_.declared_by_duration ? 2 : 0;
    if (index_.packets + slack < index_.declared) {
        const std::string cause = fmt::format("{} of {} frames", index_.packets, index_.declared);
        if (options_.strict) throw InputError(path_, cause + " are there; it ends early", export_again);
        warnings_.add(name + ": " + cause);
    } else if (index_.packets > index_.declared + slack) {
        warnings_.add(
            fmt::format("{}: its header declares {} frames, it holds {}", name, index_.declared, index_.packets));
    }
}

void VideoSource::open_decoder() {
    const AVCodecParameters& parameters = *file_->video().codecpar;
    const AVCodec* codec = avcodec_find_decoder(parameters.codec_id);
    if (codec == nullptr)
        throw InputError(path_, fmt::format("its codec {} is not supported", avcodec_get_name(parameters.codec_id)),
                         "convert it to H.264");
    decoder_ = owned(avcodec_alloc_context3(codec));
    int status = avcodec_parameters_to_context(decoder_.get(), &parameters);
    decoder_->opaque = &decoder_log_;
    decoder_->pkt_timebase = file_->video().time_base;
    decoder_->thread_count = 0;
    decoder_->max_pixels = max_image_pixels;
    decoder_->err_recognition = AV_EF_CRCCHECK;
    // Damaged frames are shown and counted; leaving them out would shift every frame behind them.
    decoder_->flags |= AV_CODEC_FLAG_OUTPUT_CORRUPT;
    if (status >= 0) status = avcodec_open2(decoder_.get(), codec, nullptr);
    if (status < 0)
        throw InputError(path_, fmt::format("its {} decoder cannot be opened ({}){}", codec->name,
                                            av_error_text(status), decoder_log_.take_cause()));
}

void VideoSource::restart() {
    open_file();
    open_decoder();
    draining_ = false;
    has_last_pts_ = false;
    next_index_ = 0;
    decoded_ = 0;
}

void VideoSource::describe(const PlateFrame& first) {
    const AVStream& stream = file_->video();
    info_.path = path_;
    info_.format = first.format();
    info_.declared_frames = index_.declared;
    info_.frame_count = index_.packets;
    info_.has_audio = file_->has_audio();
    const AVFrame& samples = *first.samples();
    info_.tags = {samples.color_primaries, samples.color_trc, samples.colorspace};
    if (options_.matrix) info_.tags.matrix = matrix_tag(info_.format.matrix);
    info_.codec = avcodec_get_name(stream.codecpar->codec_id);
    info_.time_base = rational(stream.time_base);
    const AVRational aspect = av_guess_sample_aspect_ratio(&file_->container(), &file_->video(), nullptr);
    if (aspect.num > 0 && aspect.den > 0) info_.sample_aspect = rational(aspect);
    describe_rate();
}

void VideoSource::describe_rate() {
    const AVStream& stream = file_->video();
    const AVRational guessed = av_guess_frame_rate(&file_->container(), &file_->video(), nullptr);
    if (guessed.num > 0 && guessed.den > 0) info_.frame_rate = rational(guessed);
    info_.fps = static_cast<double>(info_.frame_rate.numerator) / info_.frame_rate.denominator;
    if (!index_.ordered || index_.pts.size() < 2) return;
    const auto last = static_cast<double>(index_.pts.size() - 1);
    const auto span = static_cast<double>(index_.pts.back() - index_.pts.front());
    const double step = span / last;
    // Containers round time stamps to their time base: one tick of deviation is no variable rate.
    for (std::size_t i = 0; i < index_.pts.size(); ++i) {
        const double even = static_cast<double>(index_.pts.front()) + step * static_cast<double>(i);
        if (std::abs(static_cast<double>(index_.pts[i]) - even) > 1.5) info_.variable_frame_rate = true;
    }
    const double average = 1 / (step * av_q2d(stream.time_base));
    if (info_.variable_frame_rate || std::abs(average - info_.fps) > 0.01 * info_.fps) {
        info_.fps = average;
        info_.frame_rate = rational(av_d2q(average, 1 << 20));
    }
}

void VideoSource::feed() {
    while (true) {
        av_packet_unref(packet_.get());
        if (!file_->read(*packet_)) {
            draining_ = true;
            avcodec_send_packet(decoder_.get(), nullptr);
            return;
        }
        if (packet_->stream_index != file_->video_stream()) continue;
        const int status = avcodec_send_packet(decoder_.get(), packet_.get());
        if (status >= 0) return;
        damaged(av_error_text(status));
    }
}

std::shared_ptr<AVFrame> VideoSource::decode() {
    while (true) {
        AvPointer<AVFrame> frame = owned(av_frame_alloc());
        const int status = avcodec_receive_frame(decoder_.get(), frame.get());
        if (status == 0) return std::shared_ptr<AVFrame>(std::move(frame));
        if (status == AVERROR_EOF) return nullptr;
        if (status == AVERROR(EAGAIN) && !draining_) {
            feed();
        } else {
            damaged(av_error_text(status));
        }
    }
}

void VideoSource::damaged(const std::string& cause) {
    const std::string text = "a damaged frame";
    const std::string detail = decoder_log_.take_cause();
    if (options_.strict) throw InputError(path_, next_index_, text + ": " + cause + detail, export_again);
    warnings_.add(path_.string() + ": " + text);
}

void VideoSource::note_condition(const AVFrame& frame) {
    // Not every decoder flags what it conceals; H.265's only logs it. With several threads an error may be counted at
    // a neighbour of the frame it belongs to.
    if (frame.decode_error_flags != 0 || (frame.flags & AV_FRAME_FLAG_CORRUPT) != 0 || decoder_log_.has_errors())
        damaged("the decoder filled in what it could not read");
    if (frame.interlaced_frame != 0)
        warnings_.add(path_.string() + ": an interlaced frame is taken as a whole picture; deinterlace the clip first");
}

void VideoSource::check_unchanged(const AVFrame& frame) const {
    if (stored_format_ < 0 ||
        (frame.width == stored_width_ && frame.height == stored_height_ && frame.format == stored_format_))
        return;
    const auto name = [](int format) { return av_get_pix_fmt_name(static_cast<AVPixelFormat>(format)); };
    throw InputError(path_, next_index_,
                     fmt::format("the picture changes from {}x{} {} to {}x{} {}", stored_width_, stored_height_,
                                 name(stored_format_), frame.width, frame.height, name(frame.format)),
                     "cut the clip there");
}

void VideoSource::place_in_time(AVFrame& frame) {
    std::int64_t pts = frame.best_effort_timestamp;
    if (index_.ordered && pts != AV_NOPTS_VALUE) {
        const auto at = std::lower_bound(index_.pts.begin(), index_.pts.end(), pts) - index_.pts.begin();
        next_index_ = std::max<std::int64_t>(next_index_, at);
    }
    const std::int64_t frame_ticks =
        frame.pkt_duration > 0
            ? frame.pkt_duration
            : std::max<std::int64_t>(
                  1, av_rescale_q(1,
                                  av_inv_q(file_->video().avg_frame_rate.num > 0 ? file_->video().avg_frame_rate
                                                                                 : AVRational{25, 1}),
                                  file_->video().time_base));
    // Without a usable time stamp a frame follows the one before it.
    if (pts == AV_NOPTS_VALUE || (has_last_pts_ && pts <= last_pts_)) pts = has_last_pts_ ? last_pts_ + frame_ticks : 0;
    if (!has_last_pts_ && next_index_ == 0) first_pts_ = index_.ordered ? index_.pts.front() : pts;
    frame.pts = last_pts_ = pts;
    frame.pkt_duration = frame_ticks;
    has_last_pts_ = true;
}

std::optional<PlateFrame> VideoSource::decode_plate() {
    while (std::shared_ptr<AVFrame> frame = decode()) {
        if (frame->format == AV_PIX_FMT_PAL8) frame = without_palette(*frame);
        place_in_time(*frame);
        const std::int64_t index = next_index_;
        if (index < seek_target_) {
            decoder_log_.take_cause();  // pictures before a key frame may lack what they refer to; nobody sees them
            ++next_index_;
            ++decoded_;
            continue;
        }
        check_unchanged(*frame);
        note_condition(*frame);
        PlateFormat format = plate_format_of(*frame, rotation_deg_, options_, path_);
        stored_width_ = frame->width;
        stored_height_ = frame->height;
        stored_format_ = frame->format;
        ++next_index_;
        ++decoded_;
        const double time_s = static_cast<double>(frame->pts - first_pts_) * av_q2d(file_->video().time_base);
        return PlateFrame(std::move(frame), std::move(format), index, time_s);
    }
    return std::nullopt;
}

void VideoSource::count_missing() {
    // Interlaced footage may have two packets a frame, and VP8 and VP9 packets that show nothing.
    const AVCodecID codec = file_->video().codecpar->codec_id;
    if (!whole_run_ || !index_.ordered || codec == AV_CODEC_ID_VP8 || codec == AV_CODEC_ID_VP9) return;
    whole_run_ = false;  // said once
    if (decoded_ >= index_.packets) return;
    const std::string cause =
        fmt::format("{} of {} frames could be decoded", decoded_, std::max(index_.packets, index_.declared));
    if (options_.strict) throw InputError(path_, cause, export_again);
    warnings_.add(path_.string() + ": " + cause);
}

std::optional<PlateFrame> VideoSource::next() {
    if (ready_) return std::exchange(ready_, std::nullopt);
    std::optional<PlateFrame> frame = decode_plate();
    if (!frame) count_missing();
    return frame;
}

bool VideoSource::position_before(std::int64_t frame) {
    if (!index_.ordered || frame >= static_cast<std::int64_t>(index_.pts.size())) return false;
    const std::int64_t target_pts = index_.pts[static_cast<std::size_t>(frame)];
    const PacketIndex::KeyFrame* key = nullptr;
    for (const PacketIndex::KeyFrame& candidate : index_.key_frames) {
        if (candidate.pts <= target_pts && (key == nullptr || candidate.pts > key->pts)) key = &candidate;
    }
    if (key == nullptr) return false;
    const std::int64_t stamp = key->dts != AV_NOPTS_VALUE ? std::min(key->dts, key->pts) : key->pts;
    if (av_seek_frame(&file_->container(), file_->video_stream(), stamp, AVSEEK_FLAG_BACKWARD) < 0) return false;
    avcodec_flush_buffers(decoder_.get());
    draining_ = false;
    has_last_pts_ = false;
    next_index_ = 0;
    return true;
}

void VideoSource::seek(std::int64_t frame) {
    const std::int64_t at = ready_ ? ready_->index() : next_index_;
    if (frame == at) return;
    if (ready_ && frame > at) ready_.reset();
    whole_run_ = false;
    seek_target_ = frame;
    // Decoding on is cheaper than going back to a key frame while the target is near.
    constexpr std::int64_t near_frames = 24;
    if (frame > at && frame - at <= near_frames) {
        ready_ = decode_plate();
        return;
    }
    ready_.reset();
    if (position_before(frame)) ready_ = decode_plate();
    if (ready_ && ready_->index() == frame) return;
    // The container could not go there exactly: from the start it always works.
    restart();
    ready_ = decode_plate();
}

}  // namespace matchlight
