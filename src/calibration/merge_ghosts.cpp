// Where photographs of a series show different things.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "calibration/merge_setup.h"
#include "core/median.h"
#include "core/parallel.h"

namespace matchlight {
namespace {

/// A signal to noise ratio below which a photograph decides nothing.
constexpr float least_signal = 3;

/// Squared deviations are held at 25 and kept in tenths, so that window sums are whole numbers.
constexpr float most_deviation = 25, tenths = 10;
constexpr int window_radius = 2;

constexpr int green = 1;

bool above_noise(const MergeSetup& setup, std::size_t shot, int x, int y) {
    const float light = setup.table.light(setup.codes[shot]->at(x, y, green), green);
    return light * light > least_signal * least_signal * setup.weights[shot].variance(light, green);
}

/// A grid of at most some hundred thousand pixels: enough for what is counted over a whole picture.
int grid_stride(const MergeSetup& setup) {
    return std::max(1, std::max(setup.width(), setup.height()) / 512);
}

/// Compression carries full pixels below full beside darker ones, and would make a photograph that clips a small lamp
/// the judge of those that do not.
bool near_full(const MergeSetup& setup, std::size_t shot, int x, int y) {
    constexpr float most_light = 0.7f;
    const float* code = setup.codes[shot]->pixel(x, y);
    for (int c = 0; c < 3; ++c) {
        if (setup.clipped(code[c], c) || setup.table.light(code[c], c) > most_light * setup.weights[shot].full_light(c))
            return true;
    }
    return false;
}

std::size_t local_reference(const MergeSetup& setup, std::size_t reference, int x, int y) {
    std::size_t shot = reference;
    while (shot + 1 < setup.codes.size() && near_full(setup, shot, x, y)) ++shot;
    if (shot != reference) return shot;
    while (shot > 0 && !above_noise(setup, shot, x, y) && !setup.clipped(shot - 1, x, y)) --shot;
    return shot;
}

/// Light that a photograph shows where there is none, a channel each: twice the median over pixels whose expected light
/// is under its noise or nine stops below full. Film has fog there, compression leaves stains, and no curve tells what
/// lies under the second code. Differences below it say nothing.
std::array<float, 3> black_light(const MergeSetup& setup, std::size_t shot, std::size_t reference) {
    constexpr std::size_t least_pixels = 100;
    constexpr float darkest_told = 0.002f;
    const int stride = grid_stride(setup);
    std::array<std::vector<double>, 3> seen;
    for (int y = 0; y < setup.height(); y += stride) {
        for (int x = 0; x < setup.width(); x += stride) {
            const std::size_t local = local_reference(setup, reference, x, y);
            if (local == shot || setup.clipped(local, x, y)) continue;
            const auto ratio = static_cast<float>(setup.exposures[shot] / setup.exposures[local]);
            for (int c = 0; c < 3; ++c) {
                const float expected = ratio * setup.table.light(setup.codes[local]->at(x, y, c), c);
                const float dark = darkest_told * setup.weights[shot].full_light(c);
                if (expected * expected > std::max(setup.weights[shot].variance(0, c), dark * dark)) continue;
                seen[static_cast<std::size_t>(c)].push_back(setup.table.light(setup.codes[shot]->at(x, y, c), c));
            }
        }
    }
    std::array<float, 3> black{};
    for (std::size_t c = 0; c < 3; ++c) {
        black[c] = setup.table.light(static_cast<float>(2 * setup.table.code_step()), static_cast<int>(c));
        if (seen[c].size() >= least_pixels)
            black[c] = std::max(black[c], static_cast<float>(2 * upper_median_in_place(seen[c])));
    }
    return black;
}

/// How much a photograph's green light varies within a window around each pixel.
ImageF local_range(const MergeSetup& setup, std::size_t shot) {
    const int width = setup.width(), height = setup.height();
    ImageF rows(width, height, 2), range(width, height, 1);
    parallel_for(height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            float least = std::numeric_limits<float>::max(), greatest = 0;
            for (int dx = -window_radius; dx <= window_radius; ++dx) {
                const float code = setup.codes[shot]->at(std::clamp(x + dx, 0, width - 1), y, green);
                const float light = setup.table.light(code, green);
                least = std::min(least, light);
                greatest = std::max(greatest, light);
            }
            rows.at(x, y, 0) = least;
            rows.at(x, y, 1) = greatest;
        }
    });
    parallel_for(height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            float least = std::numeric_limits<float>::max(), greatest = 0;
            for (int dy = -window_radius; dy <= window_radius; ++dy) {
                const float* row = rows.pixel(x, std::clamp(y + dy, 0, height - 1));
                least = std::min(least, row[0]);
                greatest = std::max(greatest, row[1]);
            }
            range.at(x, y) = greatest - least;
        }
    });
    return range;
}

/// Mean over channels of the squared difference over its variance.
float squared_deviation(const MergeSetup& setup, std::size_t shot, std::size_t reference,
                        const std::array<float, 3>& black_of_shot, float range, int x, int y) {
    // A tenth of the light is what curves and exposures are off by; what moved differs by more. At edges compression,
    // the lens and a fraction of a pixel's motion carry a part of the contrast from one pixel to the next.
    constexpr float harmless = 0.1f, carried = 0.3f;
    const float* code = setup.codes[shot]->pixel(x, y);
    const float* reference_code = setup.codes[reference]->pixel(x, y);
    const auto ratio = static_cast<float>(setup.exposures[shot] / setup.exposures[reference]);
    float sum = 0;
    int channels = 0;
    for (int c = 0; c < 3; ++c) {
        if (setup.clipped(code[c], c) || setup.clipped(reference_code[c], c)) continue;
        const float seen = setup.table.light(code[c], c);
        const float reference_light = setup.table.light(reference_code[c], c);
        const float expected = std::min(ratio * reference_light, setup.weights[shot].full_light(c));
        const float black = black_of_shot[static_cast<std::size_t>(c)];
        const float tolerated = ratio * (harmless * reference_light + carried * range);
        const float variance = setup.weights[shot].variance(expected, c) + black * black + tolerated * tolerated +
                               ratio * ratio * (setup.weights[reference].variance(reference_light, c) + black * black);
        sum += (seen - expected) * (seen - expected) / variance;
        ++channels;
    }
    return channels > 0 ? sum / static_cast<float>(channels) : 0;
}

/// Sums over a square window, of a byte each, clamped at the edges.
Image<int> window_sums(const Image8& values) {
    const int width = values.width(), height = values.height();
    Image<int> rows(width, height, 1), sums(width, height, 1);
    parallel_for(height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            int sum = 0;
            for (int dx = -window_radius; dx <= window_radius; ++dx)
                sum += values.at(std::clamp(x + dx, 0, width - 1), y);
            rows.at(x, y) = sum;
        }
    });
    parallel_for(height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            int sum = 0;
            for (int dy = -window_radius; dy <= window_radius; ++dy)
                sum += rows.at(x, std::clamp(y + dy, 0, height - 1));
            sums.at(x, y) = sum;
        }
    });
    return sums;
}

/// A region disagrees where its mean squared deviation is 9 (noise: 1); its rim, which window sums miss, is taken with
/// it. Single pixels stay: one in a picture of millions lies five deviations off by chance, and weighs little.
Image8 disagreeing_regions(const Image8& deviations) {
    constexpr int side = 2 * window_radius + 1;
    constexpr int least_sum = static_cast<int>(9 * tenths) * side * side;
    const Image<int> sums = window_sums(deviations);
    const int width = deviations.width(), height = deviations.height();
    Image8 seeds(width, height, 1);
    for (std::size_t i = 0; i < seeds.samples().size(); ++i)
        seeds.samples()[i] = sums.samples()[i] >= least_sum ? 1 : 0;
    const Image<int> near = window_sums(seeds);
    Image8 mask(width, height, 1);
    for (std::size_t i = 0; i < mask.samples().size(); ++i) {
        const bool seed = seeds.samples()[i] != 0;
        const bool rim = near.samples()[i] > 0 && deviations.samples()[i] >= static_cast<int>(4 * tenths);
        mask.samples()[i] = seed || rim ? 255 : 0;
    }
    return mask;
}

}  // namespace

std::size_t best_exposed(const MergeSetup& setup) {
    constexpr float least_light = 0.02f;  // three stops below middle grey
    const int stride = grid_stride(setup);
    std::size_t best = 0;
    std::int64_t most = -1;
    for (std::size_t shot = 0; shot < setup.codes.size(); ++shot) {
        std::int64_t well = 0;
        for (int y = 0; y < setup.height(); y += stride) {
            for (int x = 0; x < setup.width(); x += stride) {
                const float light = setup.table.light(setup.codes[shot]->at(x, y, green), green);
                const bool told = light > least_light * setup.weights[shot].full_light(green);
                well += told && !setup.clipped(shot, x, y) && above_noise(setup, shot, x, y) ? 1 : 0;
            }
        }
        if (well > most) {
            most = well;
            best = shot;
        }
    }
    return best;
}

std::vector<Image8> ghost_masks(const MergeSetup& setup, std::size_t reference) {
    std::vector<ImageF> ranges;
    for (std::size_t shot = 0; shot < setup.codes.size(); ++shot) ranges.push_back(local_range(setup, shot));
    std::vector<Image8> masks;
    for (std::size_t shot = 0; shot < setup.codes.size(); ++shot) {
        Image8 deviations(setup.width(), setup.height(), 1);
        const std::array<float, 3> black = black_light(setup, shot, reference);
        parallel_for(setup.height(), [&](int y) {
            for (int x = 0; x < setup.width(); ++x) {
                const std::size_t local = local_reference(setup, reference, x, y);
                if (local == shot) continue;
                const float squared = std::min(
                    squared_deviation(setup, shot, local, black, ranges[local].at(x, y), x, y), most_deviation);
                deviations.at(x, y) = static_cast<std::uint8_t>(std::lround(squared * tenths));
            }
        });
        masks.push_back(disagreeing_regions(deviations));
    }
    return masks;
}

}  // namespace matchlight
