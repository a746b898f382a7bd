// New code values into the codec's samples, touching no block that holds no touched pixel.
#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <memory>
#include <new>

#include "media/av_pointers.h"
#include "media/chroma_siting.h"
#include "media/plate.h"
#include "media/plate_rotation.h"
#include "media/plate_rows.h"

namespace matchlight {

namespace {

// A touched pixel that hardly changed keeps the detail of the old chroma that reading by interpolation smoothed away;
// one that changed by this much (eight codes of 255) keeps nothing of it. In between linear, so that no edge shows.
constexpr float detail_kept_below = 8.0f / 255;

int sample_from_code(const SampleLayout& layout, int component, const SampleScale& scale, float code) {
    const int most = layout.component[static_cast<std::size_t>(component)].max();
    const float sample = std::nearbyint(scale.zero + scale.scale * code);
    // Written so that NaN becomes 0 instead of undefined behaviour.
    return sample > 0 ? static_cast<int>(std::min(sample, static_cast<float>(most))) : 0;
}

/// Writes the touched pixels of one frame; all coordinates are stored ones.
class PlateWriter {
public:
    PlateWriter(const AVFrame& before, AVFrame& after, const PlateFormat& format, const Region& region,
                const ImageF& rgb, const Image8& touched)
        : before_(before),
          after_(after),
          format_(format),
          region_(region),
          rgb_(rgb),
          touched_(touched),
          layout_(*SampleLayout::of(static_cast<AVPixelFormat>(after.format))),
          matrix_(format.matrix) {
        for (int c = 0; c < layout_.colours; ++c)
            scale_[static_cast<std::size_t>(c)] = sample_scale(layout_, c, format.range);
    }

    void write() {
        for (int y = 0; y < region_.height; ++y) write_pixels(y);
        if (layout_.is_chroma(1)) write_chroma();
    }

private:
    /// R', G', B' or luma, which belong to single pixels.
    void write_pixels(int y) {
        for (int x = 0; x < region_.width; ++x) {
            if (touched_.at(x, y) == 0) continue;
            const float* p = rgb_.pixel(x, y);
            if (layout_.rgb) {
                for (int c = 0; c < 3; ++c) put(c, region_.x + x, region_.y + y, p[c]);
            } else {
                put(0, region_.x + x, region_.y + y, luma(p));
            }
        }
    }

    void write_chroma() {
        const ChromaAxes axes = chroma_axes(format_.siting, layout_.log2_chroma_width, layout_.log2_chroma_height);
        const ChromaAxis::Box across = axes.horizontal.box(), down = axes.vertical.box();
        const int step_x = axes.horizontal.step, step_y = axes.vertical.step;
        const int first_block = region_.x / step_x, last_block = (region_.x + region_.width - 1) / step_x;
        // Every column that a box of these blocks reaches, inside the frame.
        const int begin = std::max(0, first_block * step_x + across.first);
        const int end =
            std::min(before_.width, last_block * step_x + across.first + static_cast<int>(across.weight.size()));
        PlateRowReader reader(before_, format_, begin, end - begin);
        for (int row = region_.y / step_y; row <= (region_.y + region_.height - 1) / step_y; ++row) {
            if (!any_touched({region_.x, row * step_y, region_.width, step_y})) continue;
            filter_down(reader, row * step_y + down.first, down, begin, end);
            for (int block = first_block; block <= last_block; ++block) {
                if (any_touched({block * step_x, row * step_y, step_x, step_y}))
                    put_chroma(block, row, block * step_x + across.first, across, begin, end);
            }
        }
    }

    /// Sums the rows of a box, weighted: what the columns bring with them, and how much of the old sample they keep.
    void filter_down(PlateRowReader& reader, int first_row, const ChromaAxis::Box& down, int begin, int end) {
        const auto width = static_cast<std::size_t>(end - begin);
        blue_.assign(width, 0);
        red_.assign(width, 0);
        kept_.assign(width, 0);
        for (std::size_t i = 0; i < down.weight.size(); ++i) {
            const int y = std::clamp(first_row + static_cast<int>(i), 0, before_.height - 1);
            const float weight = down.weight[i];
            reader.read_ycc(y, ycc_);
            for (int x = begin; x < end; ++x) {
                const auto at = static_cast<std::size_t>(x - begin);
                if (!region_.contains(x, y) || touched_.at(x - region_.x, y - region_.y) == 0) {
                    kept_[at] += weight;  // an untouched pixel stands for the old sample itself
                    continue;
                }
                const float* p = rgb_.pixel(x - region_.x, y - region_.y);
                const float new_luma = luma(p);
                const float new_blue = (p[2] - new_luma) / matrix_.blue_cb,
                            new_red = (p[0] - new_luma) / matrix_.red_cr;
                const float change = std::max(
                    {std::abs(new_luma - ycc_.a[at]), std::abs(new_blue - ycc_.b[at]), std::abs(new_red - ycc_.c[at])});
                const float detail = std::max(0.0f, 1 - change / detail_kept_below);
                blue_[at] += weight * (new_blue - detail * ycc_.b[at]);
                red_[at] += weight * (new_red - detail * ycc_.c[at]);
                kept_[at] += weight * detail;
            }
        }
    }

    void put_chroma(int column, int row, int first, const ChromaAxis::Box& across, int begin, int end) {
        float blue = 0, red = 0, kept = 0;
        for (std::size_t i = 0; i < across.weight.size(); ++i) {
            const int x = std::clamp(first + static_cast<int>(i), begin, end - 1);
            const auto at = static_cast<std::size_t>(x - begin);
            blue += across.weight[i] * blue_[at];
            red += across.weight[i] * red_[at];
            kept += across.weight[i] * kept_[at];
        }
        put(1, column, row, blue + kept * old_code(1, column, row));
        put(2, column, row, red + kept * old_code(2, column, row));
    }

    bool any_touched(const Region& block) const {
        const Region inside = block.intersected(region_);
        for (int y = inside.y; y < inside.y + inside.height; ++y) {
            const std::uint8_t* row = touched_.pixel(inside.x - region_.x, y - region_.y);
            if (std::any_of(row, row + inside.width, [](std::uint8_t t) { return t != 0; })) return true;
        }
        return false;
    }

    float luma(const float* rgb) const { return matrix_.kr * rgb[0] + matrix_.kg * rgb[1] + matrix_.kb * rgb[2]; }

    float old_code(int component, int column, int row) const {
        const SampleScale& s = scale_[static_cast<std::size_t>(component)];
        float code = 0;
        read_samples(layout_, before_, {component, column, row, 1}, s.zero, 1 / s.scale, &code);
        return code;
    }

    void put(int component, int x, int y, float code) {
        write_sample(layout_, after_, component, x, y,
                     sample_from_code(layout_, component, scale_[static_cast<std::size_t>(component)], code));
    }

    const AVFrame& before_;
    AVFrame& after_;
    const PlateFormat& format_;
    const Region region_;
    const ImageF& rgb_;
    const Image8& touched_;
    SampleLayout layout_;
    MatrixCoefficients matrix_;
    std::array<SampleScale, 3> scale_;
    PlanarRow ycc_;
    std::vector<float> blue_, red_, kept_;  // of one row of blocks, by column from `begin`
};

}  // namespace

void PlateFrame::write_rgb_code(const Region& region, const ImageF& rgb_code, const Image8& touched) {
    assert(!region.empty() && region.intersected({0, 0, format_.width, format_.height}) == region);
    assert(rgb_code.width() == region.width && rgb_code.height() == region.height && rgb_code.channels() == 3);
    assert(touched.width() == region.width && touched.height() == region.height && touched.channels() == 1);
    const std::shared_ptr<const AVFrame> before = samples_;
    const std::shared_ptr<AVFrame> after = copied_frame(*before);
    const PlateRotation rotation{format_.rotation_deg, after->width, after->height};
    if (rotation.rotation_deg == 0) {
        PlateWriter(*before, *after, format_, region, rgb_code, touched).write();
    } else {
        PlateWriter(*before, *after, format_, rotation.stored(region), rotation.to_stored(rgb_code, region),
                    rotation.to_stored(touched, region))
            .write();
    }
    samples_ = after;
}

}  // namespace matchlight
