// Kernels of glare: where the light of a bright point goes, texel by texel.
#pragma once

#include <functional>

#include <Eigen/Core>

#include "core/image.h"

namespace matchlight {

/// The texels of a kernel.
struct KernelGrid {
    int scale = 1;             // frame pixels along a side of a texel
    int most_radius = 100000;  // texels from the middle one that are kept: light that goes further is lost
};

struct KernelShape {
    double reach_px = 1;   // light goes no further, in frame pixels
    double detail_px = 1;  // how closely light is to be sampled
};

/// Texels from the middle one that light reaches.
int kernel_radius(double reach_px, int scale);

/// Light that reaches an offset from the point, RGB; the same at the opposite offset.
using LightAtOffset = std::function<Eigen::Vector3d(const Eigen::Vector2d& offset_px)>;

/// Each texel's mean of `light_at`, without what is negative (colours outside of Rec.709), then each channel scaled to
/// a sum of 1, what is lost included. The point is in the middle of the middle texel; the side is odd. Where nothing
/// reaches any texel, all light stays in the middle.
Image<double> gather_kernel(const KernelShape& shape, const KernelGrid& grid, const LightAtOffset& light_at);

/// Adds factor · part to a sum of kernels of the same scale, which grows as needed.
void add_kernel(Image<double>& sum, const Image<double>& part, double factor);

}  // namespace matchlight
