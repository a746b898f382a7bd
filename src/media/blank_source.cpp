// One black picture, handed out again with each frame's time stamp.
#include "media/blank_source.h"

#include <cstring>

#include "media/av_pointers.h"
#include "media/input_limits.h"
#include "media/plate_format.h"

extern "C" {
#include <libavutil/rational.h>
}

namespace matchlight {

namespace {

std::shared_ptr<AVFrame> black_picture(int width, int height) {
    AvPointer<AVFrame> frame = allocated_frame(width, height, AV_PIX_FMT_YUV420P);
    constexpr int black_luma = 16, no_chroma = 128;  // ITU-R BT.709, 8 bits
    for (int plane = 0; plane < 3; ++plane) {
        const int rows = plane == 0 ? height : (height + 1) / 2;
        std::memset(frame->data[plane], plane == 0 ? black_luma : no_chroma,
                    static_cast<std::size_t>(frame->linesize[plane]) * static_cast<std::size_t>(rows));
    }
    frame->colorspace = AVCOL_SPC_BT709;
    frame->color_range = AVCOL_RANGE_MPEG;
    frame->color_primaries = AVCOL_PRI_BT709;
    frame->color_trc = AVCOL_TRC_IEC61966_2_1;
    frame->chroma_location = AVCHROMA_LOC_LEFT;
    frame->sample_aspect_ratio = {1, 1};
    frame->pkt_duration = 1;
    return std::shared_ptr<AVFrame>(std::move(frame));
}

}  // namespace

BlankSource::BlankSource(const BlankFootage& footage) {
    check_image_size(footage.path, footage.width, footage.height);
    black_ = black_picture(footage.width, footage.height);
    info_.path = footage.path;
    info_.format = plate_format_of(*black_, 0, {}, footage.path);
    info_.frame_count = info_.declared_frames = footage.frames;
    info_.fps = footage.fps;
    const AVRational rate = av_d2q(footage.fps, 1 << 20);
    info_.frame_rate = {rate.num, rate.den};
    info_.time_base = {rate.den, rate.num};
    info_.tags = {AVCOL_PRI_BT709, AVCOL_TRC_IEC61966_2_1, AVCOL_SPC_BT709};
}

std::optional<PlateFrame> BlankSource::next() {
    if (next_ >= info_.frame_count) return std::nullopt;
    const std::int64_t index = next_++;
    const std::shared_ptr<AVFrame> frame(owned(av_frame_clone(black_.get())));  // shares the samples
    frame->pts = index;
    return PlateFrame(frame, info_.format, index, static_cast<double>(index) / info_.fps);
}

}  // namespace matchlight
