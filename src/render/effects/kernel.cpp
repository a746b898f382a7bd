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

/// Along an axis: 2 − B of every texel, B the quadratic B-spline (1/8, 6/8, 1/8).
void sharpen(Image<double>& kernel, int step_x, int step_y) {
    const Image<double> blurred = kernel;
    for (int y = 0; y < kernel.height(); ++y) {
        for (int x = 0; x < kernel.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                const auto at = [&](int u, int v) {
                    return blurred.bounds().contains(u, v) ? blurred.at(u, v, c) : 0.0;
                };
                kernel.at(x, y, c) =
                    std::max(0.0, 1.25 * at(x, y) - (at(x - step_x, y - step_y) + at(x + step_x, y + step_y)) / 8);
            }
        }
    }
}

Image<double> middle_of(const Image<double>& kernel, int radius) {
    const int margin = kernel.width() / 2 - radius;
    if (margin == 0) return kernel;
    Image<double> middle(2 * radius + 1, 2 * radius + 1, 3);
    for (int y = 0; y < middle.height(); ++y) {
        const double* from = kernel.pixel(margin, margin + y);
        std::copy(from, from + middle.row(y).size(), middle.row(y).begin());
    }
    return middle;
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
    // One texel more, for the sharpening of the last one.
    Image<double> kernel = gather(shape, grid.scale, std::min(radius, kept + 1), light_at);
    Eigen::Vector3d total = sum_of(kernel);
    if (kept < radius) {
        // The whole of it at a scale at which it has a bearable size.
        constexpr int fewest = 256;
        const int coarse = static_cast<int>(std::ceil(shape.reach_px / std::max(kept, fewest)));
        total = sum_of(gather(shape, coarse, kernel_radius(shape.reach_px, coarse), light_at));
    }
    // What texels of several pixels are mean over, and are interpolated from, blurs as a quadratic B-spline does:
    // undone to first order, without going below 0.
    if (grid.scale > 1) {
        const Eigen::Vector3d before = sum_of(kernel);
        sharpen(kernel, 1, 0);
        sharpen(kernel, 0, 1);
        total = total.cwiseProduct(sum_of(kernel)).cwiseQuotient(before.cwiseMax(1e-300));
    }
    kernel = middle_of(kernel, kept);
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
