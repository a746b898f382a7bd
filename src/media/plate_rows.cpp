// The loops are written plainly over whole rows, so that compilers vectorise them.
#include "media/plate_rows.h"

#include <algorithm>
#include <cassert>

namespace matchlight {

SampleScale sample_scale(const SampleLayout& layout, int component, ColorRange range) {
    const int depth = layout.component[static_cast<std::size_t>(component)].depth;
    const auto full = static_cast<float>((1 << depth) - 1);
    const bool chroma = layout.is_chroma(component);
    if (range == ColorRange::full || layout.rgb) return {chroma ? static_cast<float>(1 << (depth - 1)) : 0.0f, full};
    // Limited range is defined at 8 bits (16..235, 16..240) and shifted up for more.
    const auto unit = static_cast<float>(1 << depth) / 256.0f;
    return chroma ? SampleScale{128 * unit, 224 * unit} : SampleScale{16 * unit, 219 * unit};
}

LumaWeights luma_weights(ColorMatrix matrix) {
    switch (matrix) {
        case ColorMatrix::bt601:
            return {0.299, 0.587, 0.114};
        case ColorMatrix::bt2020:
            return {0.2627, 0.6780, 0.0593};
        case ColorMatrix::rgb:
        case ColorMatrix::bt709:
            break;
    }
    return {0.2126, 0.7152, 0.0722};
}

MatrixCoefficients::MatrixCoefficients(ColorMatrix matrix) {
    const LumaWeights k = luma_weights(matrix);
    kr = static_cast<float>(k.red);
    kg = static_cast<float>(k.green);
    kb = static_cast<float>(k.blue);
    red_cr = static_cast<float>(2 * (1 - k.red));
    blue_cb = static_cast<float>(2 * (1 - k.blue));
    green_cr = static_cast<float>(2 * (1 - k.red) * k.red / k.green);
    green_cb = static_cast<float>(2 * (1 - k.blue) * k.blue / k.green);
}

PlateRowReader::PlateRowReader(const AVFrame& frame, const PlateFormat& format, int x, int width)
    : frame_(frame),
      layout_(*SampleLayout::of(static_cast<AVPixelFormat>(frame.format))),
      matrix_(format.matrix),
      x_(x),
      width_(width) {
    assert(width > 0 && x >= 0 && x + width <= frame.width);
    for (int c = 0; c < layout_.colours; ++c) {
        const SampleScale s = sample_scale(layout_, c, format.range);
        scale_[static_cast<std::size_t>(c)] = {s.zero, 1 / s.scale};
    }
    if (!has_chroma()) return;
    const ChromaAxes axes = chroma_axes(format.siting, layout_.log2_chroma_width, layout_.log2_chroma_height);
    across_ = axes.horizontal.phases();
    down_ = axes.vertical.phases();
    const int step = axes.horizontal.step;
    first_chroma_ = x / step - 1;
    chroma_count_ = (x + width - 1) / step + 1 - first_chroma_ + 1;
}

void PlateRowReader::read_component(int component, int y, float* values) const {
    const SampleScale& s = scale_[static_cast<std::size_t>(component)];
    read_samples(layout_, frame_, {component, x_, y, width_}, s.zero, s.scale, values);
}

const float* PlateRowReader::chroma_row(int component, int row) {
    row = std::clamp(row, 0, layout_.height_of(component, frame_) - 1);
    CachedRow& cached = cache_[static_cast<std::size_t>(component)][row & 1];
    if (cached.row == row) return cached.values.data();
    cached.row = row;
    cached.values.resize(static_cast<std::size_t>(chroma_count_));
    const int begin = std::max(0, first_chroma_);
    const int end = std::min(layout_.width_of(component, frame_), first_chroma_ + chroma_count_);
    const SampleScale& s = scale_[static_cast<std::size_t>(component)];
    float* values = cached.values.data();
    const int before = begin - first_chroma_, inside = end - begin;
    read_samples(layout_, frame_, {component, begin, row, inside}, s.zero, s.scale, values + before);
    std::fill(values, values + before, values[before]);
    std::fill(values + before + inside, values + chroma_count_, values[before + inside - 1]);
    return values;
}

void PlateRowReader::interpolate_chroma(int component, int y, std::vector<float>& values) {
    const int step_down = static_cast<int>(down_.size());
    const ChromaAxis::Phase& vertical = down_[static_cast<std::size_t>(y % step_down)];
    const int row = y / step_down + vertical.first;
    const float* samples = chroma_row(component, row);
    if (vertical.weight != 0) {
        const float* below = chroma_row(component, row + 1);
        blended_.resize(static_cast<std::size_t>(chroma_count_));
        const float weight = vertical.weight;
        for (int k = 0; k < chroma_count_; ++k) blended_[k] = samples[k] + weight * (below[k] - samples[k]);
        samples = blended_.data();
    }

    const int step = static_cast<int>(across_.size());
    const int blocks = chroma_count_ - 2;  // without the neighbour at either end
    if (step <= 1) {                       // no block is narrower than a pixel
        std::copy_n(samples + 1, width_, values.data());
        return;
    }
    widened_.resize(static_cast<std::size_t>(blocks * step));
    for (int phase = 0; phase < step; ++phase) {
        const auto [first, weight] = across_[static_cast<std::size_t>(phase)];
        const float* from = samples + 1 + first;
        float* to = widened_.data() + phase;
        if (step == 2) {
            for (int k = 0; k < blocks; ++k) to[2 * k] = from[k] + weight * (from[k + 1] - from[k]);
        } else {
            for (int k = 0; k < blocks; ++k) to[step * k] = from[k] + weight * (from[k + 1] - from[k]);
        }
    }
    std::copy_n(widened_.data() + x_ % step, width_, values.data());
}

void PlateRowReader::read_ycc(int y, PlanarRow& ycc) {
    assert(has_chroma());
    ycc.resize(width_);
    read_component(0, y, ycc.a.data());
    interpolate_chroma(1, y, ycc.b);
    interpolate_chroma(2, y, ycc.c);
}

void PlateRowReader::read_rgb(int y, PlanarRow& rgb) {
    rgb.resize(width_);
    float* r = rgb.a.data();
    float* g = rgb.b.data();
    float* b = rgb.c.data();
    if (layout_.rgb) {
        read_component(0, y, r);
        read_component(1, y, g);
        read_component(2, y, b);
        return;
    }
    if (!has_chroma()) {
        read_component(0, y, r);
        std::copy_n(r, width_, g);
        std::copy_n(r, width_, b);
        return;
    }
    read_ycc(y, rgb);
    const MatrixCoefficients m = matrix_;
    for (int x = 0; x < width_; ++x) {
        const float luma = r[x], cb = g[x], cr = b[x];
        r[x] = luma + m.red_cr * cr;
        g[x] = luma - m.green_cb * cb - m.green_cr * cr;
        b[x] = luma + m.blue_cb * cb;
    }
}

void PlateRowReader::read_gray(int y, float* gray) {
    read_component(layout_.rgb ? 1 : 0, y, gray);
}

}  // namespace matchlight
