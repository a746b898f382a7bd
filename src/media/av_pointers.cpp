// Frames with buffers of their own.
#include "media/av_pointers.h"

#include <cstring>

namespace matchlight {

AvPointer<AVFrame> allocated_frame(int width, int height, int pixel_format) {
    AvPointer<AVFrame> frame = owned(av_frame_alloc());
    frame->width = width;
    frame->height = height;
    frame->format = pixel_format;
    if (av_frame_get_buffer(frame.get(), 0) < 0) throw std::bad_alloc();
    // Samples of 10 bits leave the rest of their words as they find it; encoders want zeros there.
    for (const AVBufferRef* buffer : frame->buf) {
        if (buffer != nullptr) std::memset(buffer->data, 0, buffer->size);
    }
    return frame;
}

std::shared_ptr<AVFrame> copied_frame(const AVFrame& frame) {
    AvPointer<AVFrame> copy = allocated_frame(frame.width, frame.height, frame.format);
    if (av_frame_copy(copy.get(), &frame) < 0 || av_frame_copy_props(copy.get(), &frame) < 0) throw std::bad_alloc();
    return std::shared_ptr<AVFrame>(std::move(copy));
}

}  // namespace matchlight
