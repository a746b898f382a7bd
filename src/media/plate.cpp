// A plate frame read as R'G'B' code values.
#include "media/plate.h"

#include <bit>
#include <cassert>
#include <utility>

#include "media/plate_rotation.h"
#include "media/plate_rows.h"

namespace matchlight {

namespace {

PlateRotation rotation_of(const AVFrame& frame, const PlateFormat& format) {
    return {format.rotation_deg, frame.width, frame.height};
}

/// Rounds 0 ≤ value < 2²² half to even: adding 1.5 · 2²³ leaves the integer in the low bits. Unlike lrint, vectorises.
int rounded(float value) {
    return std::bit_cast<int>(value + 12582912.0f) - std::bit_cast<int>(12582912.0f);
}

template <class Sample>
void quantise(const std::vector<float>& codes, Sample* samples) {
    constexpr auto full = static_cast<float>(static_cast<Sample>(~Sample{0}));
    const float* from = codes.data();
    const int count = static_cast<int>(codes.size());
    for (int x = 0; x < count; ++x) {
        float code = from[x] > 0 ? from[x] : 0.0f;
        code = code < 1 ? code : 1.0f;
        samples[x] = static_cast<Sample>(rounded(code * full));
    }
}

template <class Sample>
Image<Sample> quantised_rgb(const AVFrame& frame, const PlateFormat& format, const Region& region) {
    const PlateRotation rotation = rotation_of(frame, format);
    const Region stored = rotation.stored(region);
    PlateRowReader reader(frame, format, stored.x, stored.width);
    Image<Sample> image(stored.width, stored.height, 3);
    PlanarRow rgb;
    std::vector<Sample> planes(static_cast<std::size_t>(stored.width) * 3);
    Sample* r = planes.data();
    Sample* g = r + stored.width;
    Sample* b = g + stored.width;
    for (int y = 0; y < stored.height; ++y) {
        reader.read_rgb(stored.y + y, rgb);
        quantise(rgb.a, r);
        quantise(rgb.b, g);
        quantise(rgb.c, b);
        Sample* to = image.pixel(0, y);
        for (int x = 0; x < stored.width; ++x) {
            to[3 * x] = r[x];
            to[3 * x + 1] = g[x];
            to[3 * x + 2] = b[x];
        }
    }
    return rotation.displayed(std::move(image), region);
}

}  // namespace

PlateFrame::PlateFrame(std::shared_ptr<AVFrame> samples, PlateFormat format, std::int64_t index, double time_s)
    : samples_(std::move(samples)), format_(std::move(format)), index_(index), time_s_(time_s) {
    assert(samples_ && SampleLayout::of(static_cast<AVPixelFormat>(samples_->format)));
}

ImageF PlateFrame::rgb_code(const Region& region) const {
    const PlateRotation rotation = rotation_of(*samples_, format_);
    const Region stored = rotation.stored(region);
    PlateRowReader reader(*samples_, format_, stored.x, stored.width);
    ImageF image(stored.width, stored.height, 3);
    PlanarRow rgb;
    for (int y = 0; y < stored.height; ++y) {
        reader.read_rgb(stored.y + y, rgb);
        float* to = image.pixel(0, y);
        for (int x = 0; x < stored.width; ++x) {
            to[3 * x] = rgb.a[x];
            to[3 * x + 1] = rgb.b[x];
            to[3 * x + 2] = rgb.c[x];
        }
    }
    return rotation.displayed(std::move(image), region);
}

Image8 PlateFrame::rgb8(const Region& region) const {
    return quantised_rgb<std::uint8_t>(*samples_, format_, region);
}

Image16 PlateFrame::rgb16(const Region& region) const {
    return quantised_rgb<std::uint16_t>(*samples_, format_, region);
}

ImageF PlateFrame::gray_code(const Region& region) const {
    const PlateRotation rotation = rotation_of(*samples_, format_);
    const Region stored = rotation.stored(region);
    PlateRowReader reader(*samples_, format_, stored.x, stored.width);
    ImageF image(stored.width, stored.height, 1);
    for (int y = 0; y < stored.height; ++y) reader.read_gray(stored.y + y, image.pixel(0, y));
    return rotation.displayed(std::move(image), region);
}

}  // namespace matchlight
