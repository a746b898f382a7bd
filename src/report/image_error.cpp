// Sums run row by row in a fixed order, so that results do not depend on threads.
#include "report/image_error.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>

namespace matchlight {
namespace {

template <class Sample>
bool comparable(const Image<Sample>& a, const Image<Sample>& b, const Image8* mask) {
    return a.bounds() == b.bounds() && a.channels() == b.channels() &&
           (mask == nullptr || (mask->bounds() == a.bounds() && mask->channels() == 1));
}

bool counted(const Image8* mask, int x, int y) {
    return mask == nullptr || mask->at(x, y) != 0;
}

}  // namespace

std::optional<double> psnr_db(const Image8& reference, const Image8& test, const Image8* mask) {
    assert(comparable(reference, test, mask));
    const int channels = reference.channels();
    std::int64_t sum = 0;  // exact
    std::int64_t samples = 0;
    for (int y = 0; y < reference.height(); ++y) {
        for (int x = 0; x < reference.width(); ++x) {
            if (!counted(mask, x, y)) continue;
            const std::uint8_t* p = reference.pixel(x, y);
            const std::uint8_t* q = test.pixel(x, y);
            for (int c = 0; c < channels; ++c) {
                const std::int64_t difference = p[c] - q[c];
                sum += difference * difference;
            }
            samples += channels;
        }
    }
    if (samples == 0) return std::nullopt;
    if (sum == 0) return psnr_cap_db;
    const double mean = static_cast<double>(sum) / static_cast<double>(samples);
    return std::min(psnr_cap_db, 10 * std::log10(255.0 * 255.0 / mean));
}

std::optional<double> relative_rms(const ImageF& reference, const ImageF& test, const Image8* mask) {
    assert(comparable(reference, test, mask));
    double difference_sum = 0, reference_sum = 0;
    for (int y = 0; y < reference.height(); ++y) {
        double difference_row = 0, reference_row = 0;
        for (int x = 0; x < reference.width(); ++x) {
            if (!counted(mask, x, y)) continue;
            for (int c = 0; c < reference.channels(); ++c) {
                const double p = reference.at(x, y, c), q = test.at(x, y, c);
                difference_row += (q - p) * (q - p);
                reference_row += p * p;
            }
        }
        difference_sum += difference_row;
        reference_sum += reference_row;
    }
    if (!(reference_sum > 0)) return std::nullopt;
    return std::sqrt(difference_sum / reference_sum);
}

std::optional<double> masked_mean(const ImageF& map, const Image8* mask) {
    assert(map.channels() == 1 && comparable(map, map, mask));
    double sum = 0;
    std::int64_t pixels = 0;
    for (int y = 0; y < map.height(); ++y) {
        double row = 0;
        for (int x = 0; x < map.width(); ++x) {
            if (!counted(mask, x, y)) continue;
            row += map.at(x, y);
            ++pixels;
        }
        sum += row;
    }
    if (pixels == 0) return std::nullopt;
    return sum / static_cast<double>(pixels);
}

Image8 inverted_mask(const Image8& mask) {
    Image8 inverted(mask.width(), mask.height(), 1);
    std::transform(mask.samples().begin(), mask.samples().end(), inverted.samples().begin(),
                   [](std::uint8_t sample) { return static_cast<std::uint8_t>(sample == 0 ? 255 : 0); });
    return inverted;
}

double mask_share(const Image8& mask) {
    if (mask.empty()) return 0;
    const auto inside =
        std::count_if(mask.samples().begin(), mask.samples().end(), [](std::uint8_t s) { return s != 0; });
    return static_cast<double>(inside) / static_cast<double>(mask.samples().size());
}

}  // namespace matchlight
