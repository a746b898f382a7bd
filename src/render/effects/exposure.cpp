// Trimmed mean, exact exponential, key and white point; all in double precision.
#include "render/effects/exposure.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace matchlight {
namespace {

struct Block {
    double log2_mean = 0;
    double pixels = 0;
};

/// The mean over the pixels between the shares, of blocks in ascending order; a block at a border counts in part.
double trimmed_mean(const std::vector<Block>& blocks, double darkest_share, double brightest_share) {
    double pixels = 0;
    for (const Block& block : blocks) pixels += block.pixels;
    const double first = darkest_share * pixels, last = (1 - brightest_share) * pixels;
    double before = 0, sum = 0, weight = 0;
    for (const Block& block : blocks) {
        const double inside = std::min(before + block.pixels, last) - std::max(before, first);
        if (inside > 0) {
            sum += inside * block.log2_mean;
            weight += inside;
        }
        before += block.pixels;
    }
    return sum / weight;
}

}  // namespace

MeterReading read_meter(const ImageF& map, const ExposureSettings& settings) {
    std::vector<Block> blocks;
    MeterReading reading;
    for (int y = 0; y < map.height(); ++y) {
        for (int x = 0; x < map.width(); ++x) {
            const float* texel = map.pixel(x, y);
            if (!(texel[1] > 0)) continue;
            blocks.push_back({static_cast<double>(texel[0]) / texel[1], texel[1]});
            const auto brightest = static_cast<double>(texel[2]);
            reading.log2_maximum = std::max(reading.log2_maximum.value_or(brightest), brightest);
        }
    }
    if (blocks.empty()) return reading;
    std::sort(blocks.begin(), blocks.end(), [](const Block& a, const Block& b) {
        return a.log2_mean != b.log2_mean ? a.log2_mean < b.log2_mean : a.pixels < b.pixels;
    });
    reading.log2_average = trimmed_mean(blocks, settings.darkest_share, settings.brightest_share);
    return reading;
}

double adapted(double log2_now, double log2_target, double dt_s, const ExposureSettings& settings) {
    const double time_constant_s = log2_target > log2_now ? settings.to_light_s : settings.to_dark_s;
    if (!(dt_s > 0)) return log2_now;  // time stamps that stand still or run backwards
    if (!(time_constant_s > 0)) return log2_target;
    return log2_now - (log2_target - log2_now) * std::expm1(-dt_s / time_constant_s);
}

double tone_factor(double luminance, double white) {
    if (!(white > 0) || !(luminance > 0)) return 1;
    return (1 + luminance / (white * white)) / (1 + luminance);
}

std::vector<FrameExposure> exposures_of_clip(const std::vector<MeterReading>& readings,
                                             const std::vector<double>& times_s, const ExposureSettings& settings) {
    assert(readings.size() == times_s.size());
    std::vector<FrameExposure> exposures(readings.size());
    const auto first = std::find_if(readings.begin(), readings.end(),
                                    [](const MeterReading& r) { return r.log2_average.has_value(); });
    if (first == readings.end()) return exposures;
    const auto start = static_cast<std::size_t>(first - readings.begin());
    double average = *first->log2_average, maximum = *first->log2_maximum;
    for (std::size_t i = 0; i < readings.size(); ++i) {
        if (i > start && readings[i].log2_average) {
            const double dt_s = times_s[i] - times_s[i - 1];
            average = adapted(average, *readings[i].log2_average, dt_s, settings);
            maximum = adapted(maximum, *readings[i].log2_maximum, dt_s, settings);
        }
        exposures[i].ev = std::log2(settings.key) - average + settings.compensation_ev;
        exposures[i].white = settings.white.value_or(std::max(1.0, std::exp2(maximum + exposures[i].ev)));
    }
    return exposures;
}

}  // namespace matchlight
