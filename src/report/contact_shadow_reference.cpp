// Sums over the probe's upper half, row by row.
#include "report/contact_shadow_reference.h"

#include <cmath>
#include <numbers>

namespace matchlight {

Eigen::Vector3d reference_contact_shadow(const Probe& probe, const Eigen::Vector3d& point_world_m,
                                         const Occlusion& occluded) {
    const int width = probe.latlong.width();
    const int height = probe.latlong.height();
    Eigen::Vector3d open = Eigen::Vector3d::Zero();
    Eigen::Vector3d all = Eigen::Vector3d::Zero();
    for (int y = 0; y < height; ++y) {
        // Solid angle of a pixel between two polar angles: Δφ (cos θ₀ − cos θ₁).
        const double above = std::cos(std::numbers::pi * y / height);
        const double below = std::cos(std::numbers::pi * (y + 1) / height);
        const double solid_angle = 2 * std::numbers::pi / width * (above - below);
        for (int x = 0; x < width; ++x) {
            const Eigen::Vector3d direction = latlong_direction(x, y, width, height);
            if (direction.z() <= 0) break;  // the rest of the row lies under the surface too
            const float* radiance = probe.latlong.pixel(x, y);
            const Eigen::Vector3d light =
                Eigen::Vector3d(radiance[0], radiance[1], radiance[2]) * (direction.z() * solid_angle);
            all += light;
            if (!occluded(point_world_m, direction)) open += light;
        }
    }
    Eigen::Vector3d ratio = Eigen::Vector3d::Ones();
    for (int c = 0; c < 3; ++c) {
        if (all[c] > 0) ratio[c] = open[c] / all[c];
    }
    return ratio;
}

}  // namespace matchlight
