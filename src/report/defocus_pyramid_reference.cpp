// The pyramid of blurred pictures, and what each pixel takes of it.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "report/defocus_reference.h"

namespace matchlight {

namespace {

using Texel = std::array<double, 4>;

void add(Texel& sum, double weight, const Texel& texel) {
    for (std::size_t c = 0; c < 4; ++c) sum[c] += weight * texel[c];
}

struct Shares {
    Texel light{};  // times weight
    Texel share{};  // weight · circle, weight, share where nothing is, share that lies in the frame
};

/// The first texel of a level is one before the frame's.
struct Level {
    int width = 0, height = 0;
    std::vector<Shares> texels;

    Shares at(int x, int y) const {
        const bool inside = x >= -1 && y >= -1 && x < width - 1 && y < height - 1;
        return inside ? texels[static_cast<std::size_t>((y + 1) * width + x + 1)] : Shares{};
    }
};

Shares of_pixel(const DefocusImages& images, int x, int y) {
    Shares shares;
    if (!images.light.bounds().contains(x, y)) return shares;
    std::copy_n(images.light.pixel(x, y), 4, shares.light.begin());
    shares.share = {0, 0, 1, 1};
    if (images.covered(x, y)) shares.share = {std::abs(images.coc_px.at(x, y)), 1, 0, 1};
    return shares;
}

/// Of the finer level given by a function, so many texels that all it holds has its place.
template <class Finer>
Level reduced(const Finer& finer, int finer_width, int finer_height, double full_circle_px) {
    constexpr std::array<double, 4> taps{0.125, 0.375, 0.375, 0.125};
    Level level{.width = finer_width / 2 + 3, .height = finer_height / 2 + 3, .texels = {}};
    for (int y = -1; y < level.height - 1; ++y) {
        for (int x = -1; x < level.width - 1; ++x) {
            Shares sum;
            for (int i = 0; i < 16; ++i) {
                const int u = i % 4, v = i / 4;
                const double tap = taps[static_cast<std::size_t>(u)] * taps[static_cast<std::size_t>(v)];
                const Shares from = finer(2 * x - 1 + u, 2 * y - 1 + v);
                const double circle = from.share[1] > 0 ? from.share[0] / from.share[1] : 0;
                const double weight = tap * std::min(circle / full_circle_px, 1.0);
                add(sum.light, weight, from.light);
                sum.share[0] += weight * from.share[0];
                sum.share[1] += weight * from.share[1];
                sum.share[2] += tap * from.share[2];
                sum.share[3] += tap * from.share[3];
            }
            level.texels.push_back(sum);
        }
    }
    return level;
}

/// Between texels by quadratic B-splines; `number` 1 is the finest.
Shares magnified(const Level& level, int number, int x, int y) {
    const double u = (x + 0.5) / std::exp2(number) - 0.5, v = (y + 0.5) / std::exp2(number) - 0.5;
    const double middle_x = std::floor(u + 0.5), middle_y = std::floor(v + 0.5);
    const auto taps = [](double f) {
        return std::array<double, 3>{0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f)};
    };
    const std::array<double, 3> across = taps(u - middle_x), down = taps(v - middle_y);
    Shares sum;
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
            const double tap = across[static_cast<std::size_t>(i)] * down[static_cast<std::size_t>(j)];
            const Shares from = level.at(static_cast<int>(middle_x) + i - 1, static_cast<int>(middle_y) + j - 1);
            add(sum.light, tap, from.light);
            add(sum.share, tap, from.share);
        }
    }
    return sum;
}

double circle_beside(const std::vector<Level>& levels, int x, int y) {
    for (int number = static_cast<int>(levels.size()); number >= 1; --number) {
        const Texel share = magnified(levels[static_cast<std::size_t>(number) - 1], number, x, y).share;
        const double circle = share[1] > 0 ? share[0] / share[1] : 0;
        if (circle >= (number == 1 ? least_coc_px : circle_of_level_px(number - 1))) return circle;
    }
    return 0;
}

Texel looked_up(const DefocusImages& images, const std::vector<Level>& levels, int x, int y) {
    const Texel sharp = of_pixel(images, x, y).light;
    const bool covered = images.covered(x, y);
    const double circle = covered ? std::abs(images.coc_px.at(x, y)) : circle_beside(levels, x, y);
    if (circle < least_coc_px) return sharp;
    const auto of_level = [&](int number) {
        if (number == 0) return sharp;
        const Shares shares = magnified(levels[static_cast<std::size_t>(number) - 1], number, x, y);
        const double counts = std::min(circle / full_circle_of_level_px(1), 1.0);
        const double whole =
            covered ? shares.share[1] + counts * shares.share[2] : std::max(counts * shares.share[3], shares.share[1]);
        if (whole <= 0) return sharp;
        Texel light{};
        add(light, 1 / whole, shares.light);
        return light;
    };
    const int count = static_cast<int>(levels.size());
    int finer = 0;
    while (finer < count && circle_of_level_px(finer + 1) <= circle) ++finer;
    if (finer == count) return of_level(count);
    const auto variance = [](double circle_px) { return circle_px * circle_px / 16; };
    const double from = variance(circle_of_level_px(finer)), to = variance(circle_of_level_px(finer + 1));
    const double t = (variance(circle) - from) / (to - from);
    Texel sum{};
    add(sum, 1 - t, of_level(finer));
    add(sum, t, of_level(finer + 1));
    return sum;
}

}  // namespace

ImageD reference_mipmap(const DefocusImages& images, int levels) {
    const int width = images.light.width(), height = images.light.height();
    std::vector<Level> pyramid{
        reduced([&](int x, int y) { return of_pixel(images, x, y); }, width, height, full_circle_of_level_px(1))};
    for (int number = 2; number <= levels; ++number) {
        const Level& finer = pyramid.back();
        pyramid.push_back(reduced([&](int x, int y) { return finer.at(x, y); }, finer.width, finer.height,
                                  full_circle_of_level_px(number)));
    }
    ImageD result(width, height, 4);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Texel light = looked_up(images, pyramid, x, y);
            std::copy(light.begin(), light.end(), result.pixel(x, y));
        }
    }
    return result;
}

}  // namespace matchlight
