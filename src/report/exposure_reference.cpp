// Plain loops over pixels.
#include "report/exposure_reference.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/transfer.h"

namespace matchlight {

ReferenceMeter reference_meter(const ImageF& light, double black, double darkest_share, double brightest_share) {
    std::vector<double> logs;
    for (int y = 0; y < light.height(); ++y) {
        for (int x = 0; x < light.width(); ++x) {
            const float* rgb = light.pixel(x, y);
            const double luminance = luminance_rec709(rgb[0], rgb[1], rgb[2]);
            if (std::isfinite(luminance) && luminance > black) logs.push_back(std::log2(luminance));
        }
    }
    if (logs.empty()) return {};
    std::sort(logs.begin(), logs.end());
    const auto count = static_cast<double>(logs.size());
    const double first = darkest_share * count, last = (1 - brightest_share) * count;
    double sum = 0, weight = 0;
    for (std::size_t i = 0; i < logs.size(); ++i) {
        const double inside = std::min(static_cast<double>(i + 1), last) - std::max(static_cast<double>(i), first);
        if (inside <= 0) continue;
        sum += inside * logs[i];
        weight += inside;
    }
    return {sum / weight, logs.back()};
}

double reference_adaptation(double start, double target, double elapsed_s, double time_constant_s) {
    return target + (start - target) * std::exp(-elapsed_s / time_constant_s);
}

Eigen::Vector3d reference_tone(const Eigen::Vector3d& linear, double white) {
    const double luminance = luminance_rec709(linear.x(), linear.y(), linear.z());
    if (!(luminance > 0)) return linear;
    return linear * ((1 + luminance / (white * white)) / (1 + luminance));
}

}  // namespace matchlight
