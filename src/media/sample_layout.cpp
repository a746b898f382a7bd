// Rows of samples by the rule of FFmpeg's pixel format descriptors.
#include "media/sample_layout.h"

#include <bit>
#include <cassert>
#include <cstring>
#include <vector>

extern "C" {
#include <libavutil/pixdesc.h>
}

namespace matchlight {

namespace {

static_assert(std::endian::native == std::endian::little);

std::uint16_t swapped(std::uint16_t word) {
    return static_cast<std::uint16_t>(word << 8 | word >> 8);
}

bool is_byte(const SampleComponent& c) {
    return c.shift + c.depth <= 8;
}

std::uint8_t* address(const SampleLayout& layout, const AVFrame& frame, int index, int x, int y) {
    const SampleComponent& c = layout.component[static_cast<std::size_t>(index)];
    // FFmpeg's rule: in big-endian formats the offset of a byte-sized sample counts from the word's second byte.
    const int byte = is_byte(c) && layout.big_endian ? 1 : 0;
    return frame.data[c.plane] + static_cast<std::ptrdiff_t>(y) * frame.linesize[c.plane] +
           static_cast<std::ptrdiff_t>(x) * c.step + c.offset + byte;
}

/// Calls `store(i, sample)` for each sample of a row. The common steps are constants, so that these loops vectorise.
template <class Store>
void for_each_sample(const SampleLayout& layout, const AVFrame& frame, const SampleRow& row, const Store& store) {
    const SampleComponent& c = layout.component[static_cast<std::size_t>(row.component)];
    const std::uint8_t* from = address(layout, frame, row.component, row.x, row.y);
    const int mask = c.max();
    const int shift = c.shift;
    if (is_byte(c)) {
        if (c.step == 1 && c.depth == 8) {
            for (int i = 0; i < row.count; ++i) store(i, from[i]);
        } else if (c.step == 3 && c.depth == 8) {
            for (int i = 0; i < row.count; ++i) store(i, from[3 * i]);
        } else {
            for (int i = 0; i < row.count; ++i) store(i, from[static_cast<std::ptrdiff_t>(i) * c.step] >> shift & mask);
        }
        return;
    }
    if (c.step == 2 && !layout.big_endian) {
        for (int i = 0; i < row.count; ++i) {
            std::uint16_t word = 0;
            std::memcpy(&word, from + 2 * static_cast<std::ptrdiff_t>(i), 2);
            store(i, word >> shift & mask);
        }
        return;
    }
    for (int i = 0; i < row.count; ++i) {
        std::uint16_t word = 0;
        std::memcpy(&word, from + static_cast<std::ptrdiff_t>(i) * c.step, 2);
        if (layout.big_endian) word = swapped(word);
        store(i, word >> shift & mask);
    }
}

}  // namespace

std::optional<SampleLayout> SampleLayout::of(AVPixelFormat format) {
    const AVPixFmtDescriptor* descriptor = av_pix_fmt_desc_get(format);
    constexpr std::uint64_t unreadable = AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BITSTREAM | AV_PIX_FMT_FLAG_HWACCEL |
                                         AV_PIX_FMT_FLAG_FLOAT | AV_PIX_FMT_FLAG_BAYER;
    if (descriptor == nullptr || (descriptor->flags & unreadable) != 0) return std::nullopt;
    // XYZ is no Y'CbCr; the luma of UYYVYY does not lie at equal steps.
    if (format == AV_PIX_FMT_XYZ12LE || format == AV_PIX_FMT_XYZ12BE || format == AV_PIX_FMT_UYYVYY411)
        return std::nullopt;
    SampleLayout layout;
    layout.rgb = (descriptor->flags & AV_PIX_FMT_FLAG_RGB) != 0;
    layout.has_alpha = (descriptor->flags & AV_PIX_FMT_FLAG_ALPHA) != 0;
    layout.big_endian = (descriptor->flags & AV_PIX_FMT_FLAG_BE) != 0;
    layout.colours = descriptor->nb_components - (layout.has_alpha ? 1 : 0);
    if (layout.colours != 1 && layout.colours != 3) return std::nullopt;
    layout.log2_chroma_width = descriptor->log2_chroma_w;
    layout.log2_chroma_height = descriptor->log2_chroma_h;
    for (std::size_t i = 0; i < descriptor->nb_components; ++i) {
        const AVComponentDescriptor& from = descriptor->comp[i];
        if (from.depth > 16 || from.shift + from.depth > 16) return std::nullopt;
        layout.component[i] = {from.plane, from.step, from.offset, from.shift, from.depth};
    }
    return layout;
}

int SampleLayout::width_of(int index, const AVFrame& frame) const {
    return is_chroma(index) ? -((-frame.width) >> log2_chroma_width) : frame.width;
}

int SampleLayout::height_of(int index, const AVFrame& frame) const {
    return is_chroma(index) ? -((-frame.height) >> log2_chroma_height) : frame.height;
}

bool SampleLayout::same_colours(const SampleLayout& other) const {
    if (rgb != other.rgb || colours != other.colours || log2_chroma_width != other.log2_chroma_width ||
        log2_chroma_height != other.log2_chroma_height)
        return false;
    for (std::size_t i = 0; i < static_cast<std::size_t>(colours); ++i) {
        if (component[i].depth != other.component[i].depth) return false;
    }
    return true;
}

void read_samples(const SampleLayout& layout, const AVFrame& frame, const SampleRow& row, std::uint16_t* samples) {
    for_each_sample(layout, frame, row, [samples](int i, int v) { samples[i] = static_cast<std::uint16_t>(v); });
}

void read_samples(const SampleLayout& layout, const AVFrame& frame, const SampleRow& row, float zero, float scale,
                  float* values) {
    for_each_sample(layout, frame, row, [=](int i, int v) { values[i] = (static_cast<float>(v) - zero) * scale; });
}

void write_sample(const SampleLayout& layout, AVFrame& frame, int component, int x, int y, int sample) {
    const SampleComponent& c = layout.component[static_cast<std::size_t>(component)];
    std::uint8_t* to = address(layout, frame, component, x, y);
    const int mask = c.max() << c.shift;
    if (is_byte(c)) {
        *to = static_cast<std::uint8_t>((*to & ~mask) | (sample << c.shift & mask));
        return;
    }
    std::uint16_t word = 0;
    std::memcpy(&word, to, 2);
    if (layout.big_endian) word = swapped(word);
    word = static_cast<std::uint16_t>((word & ~mask) | (sample << c.shift & mask));
    if (layout.big_endian) word = swapped(word);
    std::memcpy(to, &word, 2);
}

void write_samples(const SampleLayout& layout, AVFrame& frame, const SampleRow& row, const std::uint16_t* samples) {
    for (int i = 0; i < row.count; ++i) write_sample(layout, frame, row.component, row.x + i, row.y, samples[i]);
}

void move_samples(const AVFrame& from, AVFrame& to) {
    const auto source = SampleLayout::of(static_cast<AVPixelFormat>(from.format));
    const auto target = SampleLayout::of(static_cast<AVPixelFormat>(to.format));
    assert(source && target && source->same_colours(*target) && from.width == to.width && from.height == to.height);
    std::vector<std::uint16_t> samples(static_cast<std::size_t>(from.width));
    const bool alpha = source->has_alpha && target->has_alpha &&
                       source->component[static_cast<std::size_t>(source->colours)].depth ==
                           target->component[static_cast<std::size_t>(target->colours)].depth;
    for (int c = 0; c < source->colours + (alpha ? 1 : 0); ++c) {
        for (int y = 0; y < source->height_of(c, from); ++y) {
            const SampleRow row{c, 0, y, source->width_of(c, from)};
            read_samples(*source, from, row, samples.data());
            write_samples(*target, to, row, samples.data());
        }
    }
}

}  // namespace matchlight
