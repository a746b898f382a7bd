// Demuxing through libavformat, held to the one file it was given.
#include "media/video_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/error.h"
#include "media/input_limits.h"

extern "C" {
#include <libavcodec/codec_desc.h>
#include <libavutil/dict.h>
#include <libavutil/parseutils.h>
}

namespace matchlight {

namespace {

namespace fs = std::filesystem;

// Containers that hold their own pictures. Playlists (hls, concat, dash), image patterns, devices and scripts, which
// name other files, are left out on purpose.
constexpr char container_names[] =
    "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi,mpegts,mpeg,mpegvideo,mxf,nut,asf,flv,ogg,yuv4mpegpipe,h264,hevc,ivf,"
    "dv,m4v,mjpeg,gif,apng";

class Options {
public:
    Options() = default;
    ~Options() { av_dict_free(&dictionary_); }
    Options(const Options&) = delete;
    Options& operator=(const Options&) = delete;
    void set(const char* key, const char* value) { av_dict_set(&dictionary_, key, value, 0); }
    AVDictionary** pointer() { return &dictionary_; }

private:
    AVDictionary* dictionary_ = nullptr;
};

/// The default, else the first, video stream that is no cover picture.
int find_video_stream(const AVFormatContext& container) {
    int found = -1;
    for (unsigned i = 0; i < container.nb_streams; ++i) {
        const AVStream& stream = *container.streams[i];
        if (stream.codecpar->codec_type != AVMEDIA_TYPE_VIDEO ||
            (stream.disposition & (AV_DISPOSITION_ATTACHED_PIC | AV_DISPOSITION_TIMED_THUMBNAILS)) != 0)
            continue;
        if ((stream.disposition & AV_DISPOSITION_DEFAULT) != 0) return static_cast<int>(i);
        if (found < 0) found = static_cast<int>(i);
    }
    return found;
}

void check_claimed_size(const fs::path& path, const AVStream& stream) {
    const AVCodecParameters& codec = *stream.codecpar;
    if (codec.codec_type == AVMEDIA_TYPE_VIDEO && (codec.width > 0 || codec.height > 0))
        check_image_size(path, codec.width, codec.height);
}

std::optional<double> tagged_number(const AVStream& stream, const char* key) {
    const AVDictionaryEntry* entry = av_dict_get(stream.metadata, key, nullptr, 0);
    if (entry == nullptr) return std::nullopt;
    return std::atof(entry->value);
}

std::optional<double> tagged_duration_s(const AVStream& stream) {
    const AVDictionaryEntry* entry = av_dict_get(stream.metadata, "DURATION", nullptr, 0);
    std::int64_t microseconds = 0;
    if (entry == nullptr || av_parse_time(&microseconds, entry->value, 1) < 0) return std::nullopt;
    return static_cast<double>(microseconds) / AV_TIME_BASE;
}

bool is_matroska(const AVFormatContext& container) {
    return std::strstr(container.iformat->name, "matroska") != nullptr;
}

/// Frames that the header promises.
void find_declared(AVFormatContext& container, AVStream& stream, std::int64_t index_entries, PacketIndex& index) {
    const bool quicktime = std::strstr(container.iformat->name, "mov") != nullptr;
    if (quicktime) {
        // The sample table after edit lists; of fragmented files what the fragments read so far add to it.
        index.declared = std::max<std::int64_t>(index_entries, avformat_index_get_entries_count(&stream));
        return;
    }
    if (stream.nb_frames > 0) {
        index.declared = stream.nb_frames;
        return;
    }
    if (!is_matroska(container)) return;
    if (const auto frames = tagged_number(stream, "NUMBER_OF_FRAMES")) {
        index.declared = std::llround(*frames);
        return;
    }
    const double fps = av_q2d(stream.avg_frame_rate);
    const auto tagged_s = tagged_duration_s(stream);
    if (container.duration == AV_NOPTS_VALUE && !tagged_s) return;
    if (!(fps > 0)) return;
    index.declared = std::llround(tagged_s.value_or(static_cast<double>(container.duration) / AV_TIME_BASE) * fps);
    index.declared_by_duration = true;
}

}  // namespace

AvInput open_video_container(const fs::path& path, AvLog& log) {
    require_regular_file(path);
    AvLog::install();
    AVFormatContext* context = avformat_alloc_context();
    if (context == nullptr) throw std::bad_alloc();
    context->opaque = &log;
    Options options;
    options.set("protocol_whitelist", "file");
    options.set("format_whitelist", container_names);
    // With its protocol written out, a name such as "concat:a|b" is only a name.
    const int status = avformat_open_input(&context, ("file:" + path.string()).c_str(), nullptr, options.pointer());
    if (status < 0) {  // the context is freed
        throw InputError(path, "is no video this program can read (" + av_error_text(status) + ")" + log.take_cause(),
                         "give an .mp4, .mov, .mkv, .webm, .avi or .ts file");
    }
    return AvInput(context);
}

VideoFile::VideoFile(const fs::path& path)
    : path_(path), log_(std::make_unique<AvLog>()), container_(open_video_container(path, *log_)) {
    // Before libavformat decodes a frame to learn more.
    for (unsigned i = 0; i < container_->nb_streams; ++i) check_claimed_size(path, *container_->streams[i]);
    const int status = avformat_find_stream_info(container_.get(), nullptr);
    video_stream_ = find_video_stream(*container_);
    if (video_stream_ < 0) throw InputError(path, "holds no video", "give a file with a picture track");
    check_claimed_size(path, video());
    if (status < 0)
        throw InputError(path, "its streams cannot be read (" + av_error_text(status) + ")" + log_->take_cause());
    for (unsigned i = 0; i < container_->nb_streams; ++i) {
        if (static_cast<int>(i) != video_stream_) container_->streams[i]->discard = AVDISCARD_ALL;
    }
}

bool VideoFile::has_audio() const {
    for (unsigned i = 0; i < container_->nb_streams; ++i) {
        if (container_->streams[i]->codecpar->codec_type == AVMEDIA_TYPE_AUDIO) return true;
    }
    return false;
}

bool VideoFile::read(AVPacket& packet) {
    // A cut QuickTime file gives one error a missing sample instead of an end; damaged Matroska recovers after a few.
    constexpr int patience = 64;
    for (int errors = 0; errors < patience; ++errors) {
        const int status = av_read_frame(container_.get(), &packet);
        // The last packet of a cut file is a piece of a frame.
        if (status >= 0 && (packet.flags & AV_PKT_FLAG_CORRUPT) != 0 && avio_feof(container_->pb) != 0) {
            av_packet_unref(&packet);
            return false;
        }
        if (status >= 0) return true;
        if (status == AVERROR_EOF) return false;
    }
    return false;
}

PacketIndex VideoFile::index_packets() {
    PacketIndex index;
    const AVStream& stream = video();
    const std::int64_t index_entries = avformat_index_get_entries_count(&stream);
    const AVCodecDescriptor* codec = avcodec_descriptor_get(stream.codecpar->codec_id);
    const bool reorders = codec != nullptr && (codec->props & AV_CODEC_PROP_REORDER) != 0;
    // Two packets may make one frame of interlaced footage.
    const AVFieldOrder order = stream.codecpar->field_order;
    index.ordered = order == AV_FIELD_PROGRESSIVE || order == AV_FIELD_UNKNOWN;

    const AvPointer<AVPacket> packet = owned(av_packet_alloc());
    std::int64_t last = AV_NOPTS_VALUE, discarded = 0;
    while (read(*packet)) {
        if (packet->stream_index == video_stream_ && (packet->flags & AV_PKT_FLAG_DISCARD) != 0) {
            ++discarded;
        } else if (packet->stream_index == video_stream_) {
            ++index.packets;
            if (packet->pts == AV_NOPTS_VALUE) {
                index.ordered = false;
            } else {
                index.pts.push_back(packet->pts);
                if ((packet->flags & AV_PKT_FLAG_KEY) != 0) index.key_frames.push_back({packet->pts, packet->dts});
            }
            // Frames that are not reordered are shown in the order of the file; those that are, decoded in it.
            const std::int64_t stamp = reorders ? packet->dts : packet->pts;
            if (stamp != AV_NOPTS_VALUE) {
                if (last != AV_NOPTS_VALUE && stamp <= last) index.ran_backwards = true;
                last = stamp;
            }
        }
        av_packet_unref(packet.get());
    }
    std::sort(index.pts.begin(), index.pts.end());
    if (std::adjacent_find(index.pts.begin(), index.pts.end()) != index.pts.end()) index.ran_backwards = true;
    if (index.ran_backwards) index.ordered = false;
    find_declared(*container_, video(), index_entries, index);
    if (index.declared > 0 && !index.declared_by_duration)
        index.declared = std::max<std::int64_t>(0, index.declared - discarded);
    return index;
}

}  // namespace matchlight
