// Gathers half a kernel by samples; the other half mirrors it.
#include "render/effects/kernel.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace matchlight {

namespace {

/// Each texel's light, not scaled to any sum.
Image<double> gather(const KernelShape& shape, int scale, int radius, const LightAtOffset& light_at) {
    // More points a texel find nothing that a kernel of one or two texels could show.
    constexpr double most_points = 256;
    const int points = static_cast<int>(std::clamp(std::ceil(scale / shape.detail_px), 1.0, most_points));
    const double area = std::pow(static_cast<double>(scale) / points, 2);
    Image<double> kernel(2 * radius + 1, 2 * radius + 1, 3);
    parallel_for(radius + 1, [&](int j) {
        for (int i = j == 0 ? 0 : -radius; i <= radius; ++i) {
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (int v = 0; v < points; ++v) {
                for (int u = 0; u < points; ++u) {
                    sum +=
                        light_at(Eigen::Vector2d(i + (u + 0.5) / points - 0.5, j + (v + 0.5) / points - 0.5) * scale);
                }
            }
            for (int c = 0; c < 3; ++c) {
                const double light = std::max(sum[c], 0.0) * area;
                kernel.at(radius + i, radius + j, c) = light;
                kernel.at(radius - i, radius - j, c) = light;
            }
        }
    });
    return kernel;
}

Eigen::Vector3d sum_of(const Image<double>& kernel) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int y = 0; y < kernel.height(); ++y) {
        for (int x = 0; x < kernel.width(); ++x) {
            for (int c = 0; c < 3; ++c) sum[c] += kernel.at(x, y, c);
        }
    }
    return sum;
}

}  // namespace

int kernel_radius(double reach_px, int scale) {
    constexpr double most = 1e6;  // beyond any frame
    return static_cast<int>(std::clamp(std::ceil(reach_px / scale - 0.5), 0.0, most));
}

Image<double> gather_kernel(const KernelShape& shape, const KernelGrid& grid, const LightAtOffset& light_at) {
    const int radius = kernel_radius(shape.reach_px, grid.scale);
    const int kept = std::min(radius, grid.most_radius);
    Image<double> kernel = gather(shape, grid.scale, kept, light_at);
    Eigen::Vector3d total = sum_of(kernel);
    if (kept < radius) {
        // The whole of it at a scale at which it has a bearable size.
        constexpr int fewest = 256;
        const int coarse = static_cast<int>(std::ceil(shape.reach_px / std::max(kept, fewest)));
        total = sum_of(gather(shape, coarse, kernel_radius(shape.reach_px, coarse), light_at));
    }
    for (int c = 0; c < 3; ++c) {
        if (total[c] == 0) {
            kernel.at(kept, kept, c) = 1;
            continue;
        }
        for (int y = 0; y < kernel.height(); ++y) {
            for (int x = 0; x < kernel.width(); ++x) kernel.at(x, y, c) /= total[c];
        }
    }
    return kernel;
}

void add_kernel(Image<double>& sum, const Image<double>& part, double factor) {
    if (sum.width() < part.width()) {
        Image<double> grown(part.width(), part.height(), 3);
        if (!sum.empty()) {
            const int margin = (part.width() - sum.width()) / 2;
            for (int y = 0; y < sum.height(); ++y) {
                std::copy(sum.row(y).begin(), sum.row(y).end(), grown.pixel(margin, margin + y));
            }
        }
        sum = std::move(grown);
    }
    const int margin = (sum.width() - part.width()) / 2;
    for (int y = 0; y < part.height(); ++y) {
        for (int x = 0; x < part.width(); ++x) {
            for (int c = 0; c < 3; ++c) sum.at(margin + x, margin + y, c) += factor * part.at(x, y, c);
        }
    }
}

}  // namespace matchlight
