// Reads heights; slopes by differences, cones by a tree of maxima, distances by lower envelopes of parabolas.
#include "scene/relief_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "core/error.h"
#include "core/lowercase.h"
#include "core/parallel.h"
#include "media/image_io.h"

namespace matchlight {

namespace {

/// The largest texture that the renderer's GL takes.
constexpr int largest_side = 16384;

void check_side(const std::filesystem::path& picture, int width, int height) {
    if (width <= largest_side && height <= largest_side) return;
    throw InputError(picture, fmt::format("it has {} × {} pixels; the limit is {}", width, height, largest_side));
}

/// Maxima over squares of texels, each level half the size of the one before.
std::vector<ImageF> maxima_of(const ImageF& heights) {
    std::vector<ImageF> levels{heights};
    while (levels.back().width() > 1 || levels.back().height() > 1) {
        const ImageF& fine = levels.back();
        ImageF coarse((fine.width() + 1) / 2, (fine.height() + 1) / 2, 1);
        for (int y = 0; y < coarse.height(); ++y) {
            for (int x = 0; x < coarse.width(); ++x) {
                const int right = std::min(2 * x + 1, fine.width() - 1), below = std::min(2 * y + 1, fine.height() - 1);
                coarse.at(x, y) = std::max(std::max(fine.at(2 * x, 2 * y), fine.at(right, 2 * y)),
                                           std::max(fine.at(2 * x, below), fine.at(right, below)));
            }
        }
        levels.push_back(std::move(coarse));
    }
    return levels;
}

/// Looks for the narrowest cone of one texel.
class ConeSearch {
public:
    ConeSearch(const std::vector<ImageF>& maxima, int x, int y)
        : maxima_(maxima), x_(x), y_(y), height_(maxima.front().at(x, y)) {}

    double ratio() const { return ratio_; }

    /// Through the picture that lies so many pictures away.
    void visit_picture(int pictures_right, int pictures_down) {
        shift_x_ = pictures_right * maxima_.front().width();
        shift_y_ = pictures_down * maxima_.front().height();
        visit(maxima_.size() - 1, 0, 0);
    }

private:
    /// From the texel's middle to the nearest middle of a texel in the square, along one axis.
    static double gap(int from, int first, int last) { return std::max({first - from, from - last, 0}); }

    void visit(std::size_t level, int x, int y) {
        const ImageF& fine = maxima_.front();
        const double rise = static_cast<double>(maxima_[level].at(x, y)) - height_;
        if (rise <= 0) return;
        const int size = 1 << level;
        const int first_x = x * size, first_y = y * size;
        const int last_x = std::min(first_x + size, fine.width()) - 1;
        const int last_y = std::min(first_y + size, fine.height()) - 1;
        const double across = gap(x_, first_x + shift_x_, last_x + shift_x_) / fine.width();
        const double down = gap(y_, first_y + shift_y_, last_y + shift_y_) / fine.height();
        const double distance = std::sqrt(across * across + down * down);
        if (distance >= ratio_ * rise) return;
        if (level == 0) {
            ratio_ = distance / rise;
            return;
        }
        // The nearer part first: it narrows the cone, and the rest is passed over.
        const ImageF& parts = maxima_[level - 1];
        const int near_x = x_ - shift_x_ >= first_x + size / 2 ? 1 : 0;
        const int near_y = y_ - shift_y_ >= first_y + size / 2 ? 1 : 0;
        for (int i = 0; i < 4; ++i) {
            const int part_x = 2 * x + (near_x ^ (i & 1)), part_y = 2 * y + (near_y ^ (i >> 1));
            if (part_x < parts.width() && part_y < parts.height()) visit(level - 1, part_x, part_y);
        }
    }

    const std::vector<ImageF>& maxima_;
    int x_, y_;
    int shift_x_ = 0, shift_y_ = 0;
    double height_;
    double ratio_ = 1;
};

ImageF cones_of_all(const std::vector<ImageF>& maxima, PictureWrap wrap) {
    const ImageF& heights = maxima.front();
    ImageF cones(heights.width(), heights.height(), 1);
    parallel_for(heights.height(), [&](int y) {
        for (int x = 0; x < heights.width(); ++x) {
            ConeSearch search(maxima, x, y);
            search.visit_picture(0, 0);
            // Mirrored neighbours hold the same heights no nearer; beyond a clamped edge nothing is higher than at it.
            for (int i = 0; i < 9 && wrap == PictureWrap::repeat; ++i) {
                if (i != 4) search.visit_picture(i % 3 - 1, i / 3 - 1);
            }
            cones.at(x, y) = static_cast<float>(search.ratio());
        }
    });
    return cones;
}

/// Squares of distances along one row, from those across it: lower envelope of parabolas, `spacing` apart.
void spread_along(std::vector<double>& values, double spacing) {
    const auto count = static_cast<int>(values.size());
    std::vector<int> roots;
    std::vector<double> from;  // where each parabola begins to be the lowest
    const auto square = [](double value) { return value * value; };
    const auto value_at = [&](int i) { return values[static_cast<std::size_t>(i)]; };
    for (int q = 0; q < count; ++q) {
        if (!std::isfinite(value_at(q))) continue;
        double meets = -std::numeric_limits<double>::infinity();
        while (!roots.empty()) {
            const int p = roots.back();
            meets = ((value_at(q) + square(q * spacing)) - (value_at(p) + square(p * spacing))) /
                    (2 * spacing * spacing * (q - p));
            if (meets > from.back()) break;
            roots.pop_back();
            from.pop_back();
            meets = -std::numeric_limits<double>::infinity();
        }
        roots.push_back(q);
        from.push_back(meets);
    }
    if (roots.empty()) return;
    std::vector<double> spread(values.size());
    std::size_t lowest = 0;
    for (int q = 0; q < count; ++q) {
        while (lowest + 1 < roots.size() && from[lowest + 1] <= q) ++lowest;
        spread[static_cast<std::size_t>(q)] = square((q - roots[lowest]) * spacing) + value_at(roots[lowest]);
    }
    values = std::move(spread);
}

/// The same along a row that is one of a row of pictures, or ends.
void spread_around(std::vector<double>& values, double spacing, PictureWrap wrap) {
    if (wrap == PictureWrap::clamp) return spread_along(values, spacing);
    const auto count = static_cast<int>(values.size());
    std::vector<double> thrice;
    for (int i = -count; i < 2 * count; ++i)
        thrice.push_back(values[static_cast<std::size_t>(wrapped(i, count, wrap))]);
    spread_along(thrice, spacing);
    values.assign(thrice.begin() + count, thrice.begin() + 2 * count);
}

/// The highest of the texels of each block.
ImageF reduced(const ImageF& heights, int width, int height) {
    if (width == heights.width() && height == heights.height()) return heights;
    ImageF blocks(width, height, 1);
    for (int y = 0; y < heights.height(); ++y) {
        for (int x = 0; x < heights.width(); ++x) {
            float& block = blocks.at(static_cast<int>(std::int64_t{x} * width / heights.width()),
                                     static_cast<int>(std::int64_t{y} * height / heights.height()));
            block = std::max(block, heights.at(x, y));
        }
    }
    return blocks;
}

}  // namespace

int wrapped(int texel, int size, PictureWrap wrap) {
    if (wrap == PictureWrap::clamp) return std::clamp(texel, 0, size - 1);
    const int period = wrap == PictureWrap::mirror ? 2 * size : size;
    const int within = ((texel % period) + period) % period;
    return within < size ? within : period - 1 - within;
}

double height_at(const ImageF& heights, PictureWrap wrap, double u, double v) {
    const double x = u * heights.width() - 0.5, y = v * heights.height() - 0.5;
    const double left = std::floor(x), top = std::floor(y);
    double sum = 0;
    for (int i = 0; i < 4; ++i) {
        const int right = i & 1, below = i >> 1;
        const double weight = (right == 1 ? x - left : 1 - x + left) * (below == 1 ? y - top : 1 - y + top);
        sum += weight * heights.at(wrapped(static_cast<int>(left) + right, heights.width(), wrap),
                                   wrapped(static_cast<int>(top) + below, heights.height(), wrap));
    }
    return sum;
}

ImageF read_heights(const std::filesystem::path& picture, Warnings& warnings) {
    const std::string extension = lowercase_extension(picture);
    if (extension == ".exr" || extension == ".hdr") {
        const ImageF light = read_linear_rgb(picture, warnings);
        check_side(picture, light.width(), light.height());
        ImageF heights(light.width(), light.height(), 1);
        bool is_cut = false;
        for (int y = 0; y < light.height(); ++y) {
            for (int x = 0; x < light.width(); ++x) {
                const float height = light.at(x, y);
                heights.at(x, y) = std::clamp(height, 0.0F, 1.0F);
                is_cut = is_cut || heights.at(x, y) != height;
            }
        }
        if (is_cut) warnings.add(fmt::format("{}: heights are cut to what lies from 0 to 1", picture.string()));
        return heights;
    }
    const Image16 codes = read_rgb16(picture);
    check_side(picture, codes.width(), codes.height());
    ImageF heights(codes.width(), codes.height(), 1);
    for (int y = 0; y < codes.height(); ++y) {
        for (int x = 0; x < codes.width(); ++x) heights.at(x, y) = static_cast<float>(codes.at(x, y)) / 65535.0F;
    }
    return heights;
}

ImageF slopes_of(const ImageF& heights, PictureWrap wrap) {
    const int width = heights.width(), height = heights.height();
    ImageF slopes(width, height, 2);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const float across =
                heights.at(wrapped(x + 1, width, wrap), y) - heights.at(wrapped(x - 1, width, wrap), y);
            const float down =
                heights.at(x, wrapped(y + 1, height, wrap)) - heights.at(x, wrapped(y - 1, height, wrap));
            slopes.at(x, y, 0) = across * static_cast<float>(width) / 2;
            slopes.at(x, y, 1) = down * static_cast<float>(height) / 2;
        }
    }
    return slopes;
}

ImageF cones_of(const ImageF& heights, PictureWrap wrap) {
    constexpr std::int64_t most_texels = std::int64_t{1} << 20;
    int width = heights.width(), height = heights.height();
    while (std::int64_t{width} * height > most_texels) {
        (width > height ? width : height) = (std::max(width, height) + 1) / 2;
    }
    const ImageF cones = cones_of_all(maxima_of(reduced(heights, width, height)), wrap);
    if (width == heights.width() && height == heights.height()) return cones;
    ImageF all(heights.width(), heights.height(), 1);
    for (int y = 0; y < all.height(); ++y) {
        for (int x = 0; x < all.width(); ++x) {
            all.at(x, y) = cones.at(static_cast<int>(std::int64_t{x} * width / all.width()),
                                    static_cast<int>(std::int64_t{y} * height / all.height()));
        }
    }
    return all;
}

std::vector<ImageF> distances_above(const ImageF& heights, PictureWrap wrap, double u_extent, double v_extent) {
    constexpr int most_cells = 128, layers = 32;
    const int width = std::min(heights.width(), most_cells), height = std::min(heights.height(), most_cells);
    const ImageF blocks = reduced(heights, width, height);
    const double across = u_extent / width, down = v_extent / height, deep = 1.0 / (layers - 1);
    const double beyond = std::numeric_limits<double>::infinity();
    const auto index = [&](int x, int y, int layer) {
        return (static_cast<std::size_t>(layer) * height + y) * width + x;
    };
    std::vector<double> squares(static_cast<std::size_t>(width) * height * layers, beyond);
    // Down a column the distance is known: to the height, or none within it.
    for (int layer = 0; layer < layers; ++layer) {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const double above = std::max(1 - layer * deep - blocks.at(x, y), 0.0);
                squares[index(x, y, layer)] = above * above;
            }
        }
    }
    const auto spread = [&](int lines, int count, double spacing, const auto& at) {
        parallel_for(lines * layers, [&](int i) {
            std::vector<double> row(static_cast<std::size_t>(count));
            for (int k = 0; k < count; ++k) row[static_cast<std::size_t>(k)] = squares[at(i % lines, k, i / lines)];
            spread_around(row, spacing, wrap);
            for (int k = 0; k < count; ++k) squares[at(i % lines, k, i / lines)] = row[static_cast<std::size_t>(k)];
        });
    };
    spread(height, width, across, [&](int line, int k, int layer) { return index(k, line, layer); });
    spread(width, height, down, [&](int line, int k, int layer) { return index(line, k, layer); });
    // What is between the middles of two cells may be as near as half of one on either side.
    const double spared = std::sqrt(across * across + down * down);
    std::vector<ImageF> result;
    for (int layer = 0; layer < layers; ++layer) {
        ImageF& distances = result.emplace_back(width, height, 1);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                distances.at(x, y) = static_cast<float>(std::max(std::sqrt(squares[index(x, y, layer)]) - spared, 0.0));
            }
        }
    }
    return result;
}

}  // namespace matchlight
