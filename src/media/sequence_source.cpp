// Numbers are found by looking into the folder; each picture becomes R'G'B' samples as they are in the file.
#include "media/sequence_source.h"

#include <cmath>
#include <cstring>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "media/av_pointers.h"
#include "media/image_io.h"
#include "media/plate_format.h"

extern "C" {
#include <libavutil/rational.h>
}

namespace matchlight {

namespace {

namespace fs = std::filesystem;

template <class Sample>
std::shared_ptr<AVFrame> as_frame(const Image<Sample>& image) {
    AvPointer<AVFrame> frame =
        allocated_frame(image.width(), image.height(), sizeof(Sample) == 1 ? AV_PIX_FMT_RGB24 : AV_PIX_FMT_RGB48LE);
    for (int y = 0; y < image.height(); ++y)
        std::memcpy(frame->data[0] + static_cast<std::ptrdiff_t>(y) * frame->linesize[0], image.pixel(0, y),
                    image.row(y).size_bytes());
    frame->colorspace = AVCOL_SPC_RGB;
    frame->color_range = AVCOL_RANGE_JPEG;
    return std::shared_ptr<AVFrame>(std::move(frame));
}

}  // namespace

SequenceSource::SequenceSource(const fs::path& pattern, const FootageOptions& options) : options_(options) {
    const double fps = options.sequence_fps.value_or(25);
    if (!(fps > 0) || !(fps < 1e6)) throw InputError(pattern, fmt::format("{} frames per second", fps), "set fps = 25");
    const std::vector<std::int64_t> numbers = numbers_of_pattern(pattern);
    if (numbers.empty()) throw InputError(pattern, "no file matches this pattern");
    info_.path = pattern;
    info_.is_sequence = true;
    info_.first_number = numbers.front();
    info_.frame_count = info_.declared_frames = static_cast<std::int64_t>(numbers.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const std::int64_t wanted = info_.first_number + static_cast<std::int64_t>(i);
        if (numbers[i] != wanted)
            throw InputError(numbered(pattern, wanted), static_cast<std::int64_t>(i),
                             fmt::format("the picture is missing, though {} follows", numbers[i]),
                             "complete the sequence or renumber it");
    }
    info_.fps = fps;
    const AVRational rate = av_d2q(fps, 1 << 20);
    info_.frame_rate = {rate.num, rate.den};
    info_.time_base = {rate.den, rate.num};
    const fs::path first = numbered(pattern, info_.first_number);
    bit_depth_ = picture_bit_depth(first);
    info_.codec = first.extension().empty() ? "" : first.extension().string().substr(1);
    info_.format = plate_format_of(*read(0), 0, options_, pattern);
    info_.tags = {AVCOL_PRI_BT709, AVCOL_TRC_IEC61966_2_1, AVCOL_SPC_RGB};
}

std::shared_ptr<AVFrame> SequenceSource::read(std::int64_t index) const {
    const fs::path path = numbered(info_.path, info_.first_number + index);
    std::shared_ptr<AVFrame> frame;
    try {
        frame = bit_depth_ == 8 ? as_frame(read_rgb8(path)) : as_frame(read_rgb16(path));
    } catch (const InputError& error) {
        InputErrorParts parts = error.parts();
        parts.frame = index;
        throw InputError(parts);
    }
    if (info_.format.width != 0 && (frame->width != info_.format.width || frame->height != info_.format.height))
        throw InputError(path, index,
                         fmt::format("is {}x{}, the first picture is {}x{}", frame->width, frame->height,
                                     info_.format.width, info_.format.height),
                         "make all pictures one size");
    frame->pts = index;
    frame->pkt_duration = 1;
    return frame;
}

std::optional<PlateFrame> SequenceSource::next() {
    if (next_ >= info_.frame_count) return std::nullopt;
    const std::int64_t index = next_++;
    return PlateFrame(read(index), info_.format, index, static_cast<double>(index) / info_.fps);
}

}  // namespace matchlight
