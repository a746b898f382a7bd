// Where the samples of an FFmpeg pixel format lie in memory, and rows of them in and out as numbers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

extern "C" {
#include <libavutil/frame.h>
#include <libavutil/pixfmt.h>
}

namespace matchlight {

/// One colour component: sample x of row y is the 8- or 16-bit word at data[plane] + y·linesize + x·step + offset,
/// shifted right by `shift`, `depth` bits of it.
struct SampleComponent {
    int plane = 0, step = 1, offset = 0, shift = 0, depth = 8;
    int max() const { return (1 << depth) - 1; }
};

/// Every format of whole bytes and unsigned integers: planar, semi-planar or packed, 4:4:4 to 4:1:0, grey, R'G'B',
/// either byte order. Palettes, single bits, floats and hardware surfaces have none.
struct SampleLayout {
    std::array<SampleComponent, 4> component;  // Y Cb Cr A, R G B A or Y A
    int colours = 3;                           // 1 for grey
    bool rgb = false;
    bool has_alpha = false;  // component[colours]
    bool big_endian = false;
    int log2_chroma_width = 0, log2_chroma_height = 0;

    static std::optional<SampleLayout> of(AVPixelFormat format);

    int depth() const { return component[0].depth; }
    bool is_chroma(int index) const { return !rgb && colours == 3 && (index == 1 || index == 2); }
    /// Size of a component's plane in a frame; chroma rounds up.
    int width_of(int index, const AVFrame& frame) const;
    int height_of(int index, const AVFrame& frame) const;
    /// Same colour family, subsampling and depth, so that samples can be moved one to one; alpha aside.
    bool same_colours(const SampleLayout& other) const;
};

/// `count` samples of a component from column `x` of row `y`.
struct SampleRow {
    int component = 0;
    int x = 0, y = 0, count = 0;
};
void read_samples(const SampleLayout& layout, const AVFrame& frame, const SampleRow& row, std::uint16_t* samples);
/// The same as (sample − zero) · scale.
void read_samples(const SampleLayout& layout, const AVFrame& frame, const SampleRow& row, float zero, float scale,
                  float* values);
void write_samples(const SampleLayout& layout, AVFrame& frame, const SampleRow& row, const std::uint16_t* samples);
void write_sample(const SampleLayout& layout, AVFrame& frame, int component, int x, int y, int sample);

/// Copies every sample of `from` into `to`, which has the same size and `same_colours`; alpha where both have it.
void move_samples(const AVFrame& from, AVFrame& to);

}  // namespace matchlight
