// Pixel storage: a row-major, interleaved image and the rectangle that names a part of one.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace matchlight {

/// A half-open rectangle of pixels, [x, x + width) × [y, y + height).
struct Region {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;

    bool empty() const { return width <= 0 || height <= 0; }
    bool contains(int px, int py) const { return px >= x && py >= y && px < x + width && py < y + height; }
    bool operator==(const Region&) const = default;

    Region intersected(const Region& other) const {
        const int left = std::max(x, other.x);
        const int top = std::max(y, other.y);
        const int right = std::min(x + width, other.x + other.width);
        const int bottom = std::min(y + height, other.y + other.height);
        return {left, top, std::max(0, right - left), std::max(0, bottom - top)};
    }
    /// The smallest rectangle that holds both; an empty one adds nothing.
    Region united(const Region& other) const {
        if (empty()) return other;
        if (other.empty()) return *this;
        const int left = std::min(x, other.x);
        const int top = std::min(y, other.y);
        const int right = std::max(x + width, other.x + other.width);
        const int bottom = std::max(y + height, other.y + other.height);
        return {left, top, right - left, bottom - top};
    }
    Region moved(int right, int down) const { return {x + right, y + down, width, height}; }
    Region grown(int pixels) const { return {x - pixels, y - pixels, width + 2 * pixels, height + 2 * pixels}; }
};

/// Interleaved samples, row 0 at the top; `at(x, y, c)` counts from the top-left pixel.
template <class Sample>
class Image {
public:
    Image() = default;
    Image(int width, int height, int channels, Sample fill = Sample{})
        : width_(width), height_(height), channels_(channels), samples_(checked_size(width, height, channels), fill) {}

    int width() const { return width_; }
    int height() const { return height_; }
    int channels() const { return channels_; }
    bool empty() const { return samples_.empty(); }
    Region bounds() const { return {0, 0, width_, height_}; }

    Sample* pixel(int x, int y) {
        assert(bounds().contains(x, y));
        return samples_.data() + (static_cast<std::size_t>(y) * width_ + x) * channels_;
    }
    const Sample* pixel(int x, int y) const {
        assert(bounds().contains(x, y));
        return samples_.data() + (static_cast<std::size_t>(y) * width_ + x) * channels_;
    }
    Sample& at(int x, int y, int channel = 0) { return pixel(x, y)[channel]; }
    const Sample& at(int x, int y, int channel = 0) const { return pixel(x, y)[channel]; }
    std::span<Sample> row(int y) { return {pixel(0, y), static_cast<std::size_t>(width_) * channels_}; }
    std::span<const Sample> row(int y) const { return {pixel(0, y), static_cast<std::size_t>(width_) * channels_}; }
    std::span<Sample> samples() { return samples_; }
    std::span<const Sample> samples() const { return samples_; }

private:
    static std::size_t checked_size(int width, int height, int channels) {
        assert(width >= 0 && height >= 0 && channels >= 0);
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(channels);
    }

    int width_ = 0;
    int height_ = 0;
    int channels_ = 0;
    std::vector<Sample> samples_;
};

using ImageF = Image<float>;
using Image8 = Image<std::uint8_t>;
using Image16 = Image<std::uint16_t>;

}  // namespace matchlight
