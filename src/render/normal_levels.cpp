// Moments of unit normals, halved level by level in single precision.
#include "render/normal_levels.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "core/parallel.h"

namespace matchlight {

namespace {

/// x, y, z and x² + y² of the unit normal of each texel.
ImageF moments_of(const Image8& rgba) {
    ImageF moments(rgba.width(), rgba.height(), 4);
    parallel_for(rgba.height(), [&](int y) {
        for (int x = 0; x < rgba.width(); ++x) {
            const std::uint8_t* code = rgba.pixel(x, y);
            const auto component = [&](int c) { return static_cast<float>(code[c]) / 127.5F - 1; };
            const float length = std::hypot(component(0), component(1), component(2));
            float* moment = moments.pixel(x, y);
            for (int c = 0; c < 3; ++c) moment[c] = length > 0 ? component(c) / length : (c == 2 ? 1.0F : 0.0F);
            moment[3] = moment[0] * moment[0] + moment[1] * moment[1];
        }
    });
    return moments;
}

/// Of an odd size the middle texel counts for both that share it.
ImageF half_as_large(const ImageF& finer) {
    ImageF coarser(std::max(finer.width() / 2, 1), std::max(finer.height() / 2, 1), 4);
    const auto first = [](int i, int count, int of) { return i * of / count; };
    const auto end = [](int i, int count, int of) { return ((i + 1) * of + count - 1) / count; };
    parallel_for(coarser.height(), [&](int y) {
        for (int x = 0; x < coarser.width(); ++x) {
            Eigen::Vector4f sum = Eigen::Vector4f::Zero();
            float count = 0;
            for (int v = first(y, coarser.height(), finer.height()); v < end(y, coarser.height(), finer.height());
                 ++v) {
                for (int u = first(x, coarser.width(), finer.width()); u < end(x, coarser.width(), finer.width());
                     ++u) {
                    sum += Eigen::Map<const Eigen::Vector4f>(finer.pixel(u, v));
                    count += 1;
                }
            }
            Eigen::Map<Eigen::Vector4f>(coarser.pixel(x, y)) = sum / count;
        }
    });
    return coarser;
}

Image8 codes_of(const ImageF& moments) {
    Image8 rgba(moments.width(), moments.height(), 4);
    for (int y = 0; y < rgba.height(); ++y) {
        for (int x = 0; x < rgba.width(); ++x) {
            const float* moment = moments.pixel(x, y);
            std::uint8_t* code = rgba.pixel(x, y);
            for (int c = 0; c < 3; ++c) code[c] = static_cast<std::uint8_t>(std::lround(127.5F * (moment[c] + 1)));
            const float variance = moment[3] - moment[0] * moment[0] - moment[1] * moment[1];
            code[3] = static_cast<std::uint8_t>(std::lround(255 * std::sqrt(std::clamp(variance, 0.0F, 1.0F))));
        }
    }
    return rgba;
}

}  // namespace

std::vector<Image8> normal_levels(const Image8& rgba) {
    std::vector<Image8> levels{rgba};
    for (int y = 0; y < rgba.height(); ++y) {
        for (int x = 0; x < rgba.width(); ++x) levels.front().pixel(x, y)[3] = 0;
    }
    for (ImageF moments = moments_of(rgba); moments.width() > 1 || moments.height() > 1;) {
        moments = half_as_large(moments);
        levels.push_back(codes_of(moments));
    }
    return levels;
}

}  // namespace matchlight
