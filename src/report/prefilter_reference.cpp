// Sums over the probe.
#include "report/prefilter_reference.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "core/parallel.h"

namespace matchlight {

ImageF reference_glossy_latlong(const Probe& probe, double roughness, int width) {
    struct Light {
        Eigen::Vector3d direction, radiance;
        double solid_angle = 0;
    };
    const int probe_width = probe.latlong.width(), probe_height = probe.latlong.height();
    std::vector<Light> lights;
    for (int y = 0; y < probe_height; ++y) {
        const double step = std::numbers::pi / probe_height;
        const double solid_angle = 2 * std::numbers::pi / probe_width * (std::cos(y * step) - std::cos((y + 1) * step));
        for (int x = 0; x < probe_width; ++x) {
            const float* radiance = probe.latlong.pixel(x, y);
            lights.push_back({latlong_direction(x, y, probe_width, probe_height),
                              Eigen::Vector3d(radiance[0], radiance[1], radiance[2]), solid_angle});
        }
    }
    const double alpha2 = std::pow(roughness, 4);
    ImageF picture(width, width / 2, 3);
    parallel_for(picture.height(), [&](int y) {
        for (int x = 0; x < width; ++x) {
            const Eigen::Vector3d axis = latlong_direction(x, y, width, width / 2);
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            double weight = 0;
            for (const Light& light : lights) {
                const double cosine = axis.dot(light.direction);
                if (cosine <= 0) continue;
                // n·h of the half vector between the axis and the light: cos²(θ/2).
                const double half2 = (1 + cosine) / 2;
                const double base = half2 * (alpha2 - 1) + 1;
                const double share = cosine / (base * base) * light.solid_angle;
                sum += share * light.radiance;
                weight += share;
            }
            for (int c = 0; c < 3; ++c) picture.at(x, y, c) = static_cast<float>(sum[c] / weight);
        }
    });
    return picture;
}

ImageF reference_mirror_latlong(const Probe& probe, int rays, int width) {
    ImageF picture(width, width / 2, 3);
    parallel_for(picture.height(), [&](int y) {
        for (int x = 0; x < width; ++x) {
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (int i = 0; i < rays * rays; ++i) {
                const int column = i % rays, row = i / rays;
                const double right = (column + 0.5) / rays - 0.5, down = (row + 0.5) / rays - 0.5;
                sum += probe.radiance(latlong_direction(x + right, y + down, width, width / 2));
            }
            sum /= rays * rays;
            for (int c = 0; c < 3; ++c) picture.at(x, y, c) = static_cast<float>(sum[c]);
        }
    });
    return picture;
}

}  // namespace matchlight
