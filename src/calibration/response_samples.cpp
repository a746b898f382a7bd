// Choice of places, and the refusal of series that tell nothing.
#include "calibration/response_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <fmt/format.h>

#include "core/error.h"

namespace matchlight {
namespace {

/// Places looked for: some fifty for each code of 8 bits, before half are held out.
constexpr int most_places = 12'000;
/// The picture is held out in a checkerboard of so many blocks a side.
constexpr int checkers = 16;

/// The largest code that a channel of any photograph shows often; codes beyond are single damaged pixels.
float largest_code(const ExposureSeries& series) {
    constexpr int levels = 256;
    constexpr std::int64_t often = 20;
    std::array<std::int64_t, levels> counts{};
    for (const Photograph& shot : series.shots) {
        for (const float code : shot.code.samples())
            ++counts[static_cast<std::size_t>(std::lround(std::clamp(code, 0.0f, 1.0f) * (levels - 1)))];
    }
    for (int level = levels - 1; level > 0; --level) {
        if (counts[static_cast<std::size_t>(level)] >= often) return static_cast<float>(level) / (levels - 1);
    }
    return 1;
}

struct Window {
    std::array<float, 3> mean{}, least{1, 1, 1}, greatest{};
};

Window window_at(const ImageF& code, int x, int y) {
    Window window;
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            const float* pixel = code.pixel(x + dx, y + dy);
            for (std::size_t c = 0; c < 3; ++c) {
                window.mean[c] += pixel[c] / 9;
                window.least[c] = std::min(window.least[c], pixel[c]);
                window.greatest[c] = std::max(window.greatest[c], pixel[c]);
            }
        }
    }
    return window;
}

/// How uneven the photographs are around a place.
float unevenness(const ExposureSeries& series, int x, int y) {
    float sum = 0;
    for (const Photograph& shot : series.shots) {
        const Window window = window_at(shot.code, x, y);
        for (std::size_t c = 0; c < 3; ++c) sum += window.greatest[c] - window.least[c];
    }
    return sum;
}

}  // namespace

ResponseSamples::ResponseSamples(const ExposureSeries& series) {
    const Photograph& first = series.shots.front();
    if (series.shots.size() < 2) {
        throw InputError(first.path, "one photograph cannot tell a response",
                         "give photographs of the same scene at different exposures");
    }
    if (first.linear) throw InputError(first.path, "raw files are linear and have no response to find");
    if (series.width() < 3 || series.height() < 3) throw InputError(first.path, "is too small to tell a response");
    for (const Photograph& shot : series.shots) {
        log_exposures_.push_back(std::log(shot.exposure));
        code_step_ = std::max(code_step_, shot.code_step);
    }
    full_code_ = largest_code(series);

    const double area = static_cast<double>(series.width()) * series.height();
    const int side = std::max(3, static_cast<int>(std::ceil(std::sqrt(area / most_places))));
    const int step = std::max(1, side / 3);
    for (int top = 1; top + 1 < series.height(); top += side) {
        for (int left = 1; left + 1 < series.width(); left += side) {
            int best_x = left, best_y = top;
            float least = std::numeric_limits<float>::infinity();
            for (int y = top; y < std::min(top + side, series.height() - 1); y += step) {
                for (int x = left; x < std::min(left + side, series.width() - 1); x += step) {
                    const float uneven = unevenness(series, x, y);
                    if (uneven >= least) continue;
                    least = uneven;
                    best_x = x;
                    best_y = y;
                }
            }
            add_place(series, best_x, best_y);
        }
    }

    leave_out_drowned();
    for (int channel = 0; channel < 3; ++channel) {
        std::size_t equations = 0;
        for (std::size_t place = 0; place < places(); ++place) {
            std::size_t usable_codes = 0;
            for (std::size_t j = 0; j < photographs(); ++j) usable_codes += usable(place, j, channel) ? 1 : 0;
            equations += usable_codes > 1 ? usable_codes - 1 : 0;
        }
        const Span codes = span(channel);
        const double unknowns = std::max(0.0, (codes.greatest - codes.least) * 255.0);
        if (static_cast<double>(equations) > unknowns && equations >= 100) continue;
        constexpr std::array<const char*, 3> names = {"red", "green", "blue"};
        throw InputError(first.path,
                         fmt::format("the photographs cannot tell a response: in {} only {} places are neither black "
                                     "nor full in two of them",
                                     names[static_cast<std::size_t>(channel)], equations),
                         "give exposures one or two stops apart that show the scene from dark to bright");
    }
}

void ResponseSamples::add_place(const ExposureSeries& series, int x, int y) {
    for (const Photograph& shot : series.shots) {
        const Window window = window_at(shot.code, x, y);
        for (std::size_t c = 0; c < 3; ++c) {
            // A code more or less is what compression moves them by.
            const auto margin = static_cast<float>(1.5 * code_step_);
            const bool full = window.greatest[c] >= full_code_ - margin;
            codes_.push_back(full ? std::numeric_limits<float>::quiet_NaN() : window.mean[c]);
            touches_black_.push_back(window.least[c] <= 0);
        }
    }
    const int column = x * checkers / series.width(), row = y * checkers / series.height();
    held_out_.push_back((column + row) % 2 == 1);
    parts_.push_back(column * 4 / checkers + 4 * (row * 4 / checkers));
}

/// Where noise carries pixels of some light to black, those it does not carry there are too bright on average. Which
/// light that is must be told by the next longer exposure: told by a photograph's own codes, the dark ones of each
/// light would be left out, and the bright ones kept.
void ResponseSamples::leave_out_drowned() {
    constexpr std::size_t bins = 64;
    const auto at = [this](std::size_t place, std::size_t photograph, std::size_t channel) {
        return (place * photographs() + photograph) * 3 + channel;
    };
    std::vector<bool> drowned(codes_.size());
    for (std::size_t channel = 0; channel < 3; ++channel) {
        for (std::size_t j = 0; j < photographs(); ++j) {
            const auto bin_of = [&](std::size_t place) {
                const float longer = codes_[at(place, j - 1, channel)];
                return std::min(static_cast<std::size_t>(longer * bins), bins - 1);
            };
            std::array<double, bins> black{}, all{};
            for (std::size_t place = 0; j > 0 && place < places(); ++place) {
                if (std::isnan(codes_[at(place, j - 1, channel)])) continue;
                all[bin_of(place)] += 1;
                black[bin_of(place)] += touches_black_[at(place, j, channel)] ? 1 : 0;
            }
            for (std::size_t place = 0; place < places(); ++place) {
                const std::size_t own = at(place, j, channel);
                const bool longer_is_full = j == 0 || std::isnan(codes_[at(place, j - 1, channel)]);
                if (longer_is_full) {
                    drowned[own] = touches_black_[own];
                } else {
                    // One window of nine pixels in a hundred: each lies three deviations above black.
                    const std::size_t bin = bin_of(place);
                    drowned[own] = drowned[at(place, j - 1, channel)] || black[bin] > 0.01 * all[bin];
                }
            }
        }
    }
    for (std::size_t i = 0; i < codes_.size(); ++i) {
        if (drowned[i]) codes_[i] = std::numeric_limits<float>::quiet_NaN();
    }
}

ResponseSamples::Span ResponseSamples::span(int channel) const {
    Span codes;
    for (std::size_t place = 0; place < places(); ++place) {
        for (std::size_t j = 0; j < photographs(); ++j) {
            if (!usable(place, j, channel)) continue;
            codes.least = std::min(codes.least, code(place, j, channel));
            codes.greatest = std::max(codes.greatest, code(place, j, channel));
        }
    }
    return codes;
}

}  // namespace matchlight
