// Rows are weighted by their solid angle, and a pixel that two new ones share by what each has of it.
#include "lighting/latlong_pyramid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"

namespace matchlight {
namespace {

/// A run of old rows or columns that make a new one, with weights that sum to 1.
struct Share {
    int first = 0;
    std::vector<double> weights;
};

/// `measure(a, b)` is the size of the part [a, b] of the axis, which runs from 0 to 1.
template <class Measure>
std::vector<Share> shares(int from, int to, const Measure& measure) {
    std::vector<Share> result(static_cast<std::size_t>(to));
    for (int i = 0; i < to; ++i) {
        const double low = static_cast<double>(i) / to, high = static_cast<double>(i + 1) / to;
        Share& share = result[static_cast<std::size_t>(i)];
        share.first = static_cast<int>(static_cast<std::int64_t>(i) * from / to);
        for (int j = share.first;
             j < from && static_cast<std::int64_t>(j) * to < static_cast<std::int64_t>(i + 1) * from; ++j) {
            const double a = std::max(low, static_cast<double>(j) / from);
            const double b = std::min(high, static_cast<double>(j + 1) / from);
            share.weights.push_back(measure(a, b) / measure(low, high));
        }
    }
    return result;
}

}  // namespace

ImageF shrunk_latlong(const ImageF& image, int width, int height) {
    const auto columns = shares(image.width(), width, [](double a, double b) { return b - a; });
    const auto rows = shares(image.height(), height, [](double a, double b) {
        return std::cos(a * std::numbers::pi) - std::cos(b * std::numbers::pi);
    });
    ImageF shrunk(width, height, image.channels());
    parallel_for(height, [&](int y) {
        const Share& row = rows[static_cast<std::size_t>(y)];
        for (int x = 0; x < width; ++x) {
            const Share& column = columns[static_cast<std::size_t>(x)];
            for (int c = 0; c < image.channels(); ++c) {
                double sum = 0;
                for (std::size_t j = 0; j < row.weights.size(); ++j) {
                    for (std::size_t i = 0; i < column.weights.size(); ++i) {
                        sum += row.weights[j] * column.weights[i] *
                               image.at(column.first + static_cast<int>(i), row.first + static_cast<int>(j), c);
                    }
                }
                shrunk.at(x, y, c) = static_cast<float>(sum);
            }
        }
    });
    return shrunk;
}

std::vector<ImageF> latlong_pyramid(const ImageF& latlong) {
    std::vector<ImageF> levels{latlong};
    while (levels.back().width() > 1 || levels.back().height() > 1) {
        levels.push_back(shrunk_latlong(levels.back(), std::max(1, levels.back().width() / 2),
                                        std::max(1, levels.back().height() / 2)));
    }
    return levels;
}

}  // namespace matchlight
