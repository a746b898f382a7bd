// Owners of what FFmpeg's libraries allocate.
#pragma once

#include <memory>
#include <new>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/frame.h>
}

namespace matchlight {

struct AvDeleter {
    void operator()(AVFrame* frame) const { av_frame_free(&frame); }
    void operator()(AVPacket* packet) const { av_packet_free(&packet); }
    void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
};
template <class T>
using AvPointer = std::unique_ptr<T, AvDeleter>;

/// FFmpeg allocates with null for "no memory".
template <class T>
AvPointer<T> owned(T* pointer) {
    if (pointer == nullptr) throw std::bad_alloc();
    return AvPointer<T>(pointer);
}

/// Demuxer; closes its file.
struct AvInputCloser {
    void operator()(AVFormatContext* context) const { avformat_close_input(&context); }
};
using AvInput = std::unique_ptr<AVFormatContext, AvInputCloser>;

/// A frame with buffers of its own, all zero, of this size and format.
AvPointer<AVFrame> allocated_frame(int width, int height, int pixel_format);
/// A copy with buffers of its own: samples, time stamps, tags.
std::shared_ptr<AVFrame> copied_frame(const AVFrame& frame);

}  // namespace matchlight
