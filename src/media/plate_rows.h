// Rows of a frame in the stored orientation as code values in float: Y'CbCr with chroma interpolated, and R'G'B'.
#pragma once

#include <array>
#include <vector>

#include "media/chroma_siting.h"
#include "media/plate.h"
#include "media/sample_layout.h"

namespace matchlight {

/// Sample = zero + scale · code value, for one component.
struct SampleScale {
    float zero = 0, scale = 255;
};
/// Code values of luma, R', G', B' run 0..1, of chroma −½..½ (ITU-R BT.709-6, 3.5; BT.2100-2, table 9).
SampleScale sample_scale(const SampleLayout& layout, int component, ColorRange range);

/// Luma weights of a matrix; R'G'B' is given BT.709's, for turning colour into grey.
struct LumaWeights {
    double red = 0, green = 0, blue = 0;
};
LumaWeights luma_weights(ColorMatrix matrix);

/// Y'CbCr to R'G'B' and back, in float as the rows are.
struct MatrixCoefficients {
    explicit MatrixCoefficients(ColorMatrix matrix);
    float kr, kg, kb;       // Y' = kr R' + kg G' + kb B'
    float red_cr, blue_cb;  // R' = Y' + red_cr Cr, B' = Y' + blue_cb Cb
    float green_cr, green_cb;
};

/// Three rows of one width, reused from row to row.
struct PlanarRow {
    std::vector<float> a, b, c;
    void resize(int width) {
        a.resize(static_cast<std::size_t>(width));
        b.resize(static_cast<std::size_t>(width));
        c.resize(static_cast<std::size_t>(width));
    }
};

/// Reads rows [x, x + width) of one frame.
class PlateRowReader {
public:
    PlateRowReader(const AVFrame& frame, const PlateFormat& format, int x, int width);

    const SampleLayout& layout() const { return layout_; }
    bool has_chroma() const { return layout_.is_chroma(1); }
    /// Y', Cb, Cr with chroma interpolated; only for formats that have chroma.
    void read_ycc(int y, PlanarRow& ycc);
    /// R', G', B' of any format, not clipped.
    void read_rgb(int y, PlanarRow& rgb);
    /// Y', or G' of R'G'B' formats.
    void read_gray(int y, float* gray);

private:
    void read_component(int component, int y, float* values) const;
    const float* chroma_row(int component, int row);
    void interpolate_chroma(int component, int y, std::vector<float>& values);

    const AVFrame& frame_;
    SampleLayout layout_;
    MatrixCoefficients matrix_;
    std::array<SampleScale, 3> scale_;
    int x_, width_;

    // Chroma samples first_chroma_ .. first_chroma_ + chroma_count_ − 1, those outside the plane repeating its edge.
    int first_chroma_ = 0, chroma_count_ = 0;
    std::vector<ChromaAxis::Phase> across_, down_;
    struct CachedRow {
        int row = -1;
        std::vector<float> values;
    };
    std::array<std::array<CachedRow, 2>, 3> cache_;  // [component][row & 1]
    std::vector<float> blended_, widened_;
};

}  // namespace matchlight
