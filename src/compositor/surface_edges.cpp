// Works on knowledge, the alpha of the picture.
#include "compositor/surface_edges.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "core/parallel.h"

namespace matchlight {

namespace {

constexpr float known = 0.5f;
constexpr int hole_passes = 3;  // a hole seven texels wide is closed
constexpr float edge_texels = 16;

}  // namespace

void close_holes(GatheredSurface& gathered) {
    ImageF& picture = gathered.radiance;
    for (int pass = 0; pass < hole_passes; ++pass) {
        const ImageF before = picture;
        parallel_for(picture.height(), [&](int y) {
            for (int x = 0; x < picture.width(); ++x) {
                if (before.at(x, y, 3) >= known) continue;
                Eigen::Vector4d sum = Eigen::Vector4d::Zero();
                int neighbours = 0;
                for (int i = 0; i < 9; ++i) {
                    const int u = x + i % 3 - 1, v = y + i / 3 - 1;
                    if (!before.bounds().contains(u, v) || before.at(u, v, 3) < known) continue;
                    sum += Eigen::Map<const Eigen::Vector4f>(before.pixel(u, v)).cast<double>();
                    ++neighbours;
                }
                constexpr int most_of_eight = 5;
                if (neighbours < most_of_eight) continue;
                Eigen::Map<Eigen::Vector4f>(picture.pixel(x, y)) = (sum / neighbours).cast<float>();
            }
        });
    }
}

void soften_edges(GatheredSurface& gathered) {
    ImageF& picture = gathered.radiance;
    const int width = picture.width(), height = picture.height();
    // Distances to the nearest unknown texel by two sweeps of a chamfer (Borgefors 1986, "Distance Transformations in
    // Digital Images"): within 8 % of Euclid's.
    constexpr float step = 1, diagonal = 1.3507f;
    ImageF distance(width + 2, height + 2, 1);  // beyond the border nothing is known
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) distance.at(x + 1, y + 1) = picture.at(x, y, 3) < known ? 0 : edge_texels + 1;
    }
    const auto reach = [&](int x, int y, int way) {
        float& here = distance.at(x, y);
        here = std::min({here, distance.at(x - way, y) + step, distance.at(x, y - way) + step,
                         distance.at(x - way, y - way) + diagonal, distance.at(x + way, y - way) + diagonal});
    };
    for (int y = 1; y <= height; ++y) {
        for (int x = 1; x <= width; ++x) reach(x, y, 1);
    }
    for (int y = height; y >= 1; --y) {
        for (int x = width; x >= 1; --x) reach(x, y, -1);
    }
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const float t = std::min(distance.at(x + 1, y + 1) / edge_texels, 1.0f);
            float& knowledge = picture.at(x, y, 3);
            knowledge = knowledge < known ? 0 : knowledge * t * t * (3 - 2 * t);
        }
    }
}

void round_to_half(ImageF& image) {
    constexpr float largest_half = 65504;
    for (float& value : image.samples()) value = static_cast<float>(Eigen::half(std::min(value, largest_half)));
}

}  // namespace matchlight
