// Peak growing over the lat-long image, which wraps in longitude.
#include "lighting/dominant_lights.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "core/transfer.h"
#include "lighting/latlong_grid.h"

namespace matchlight {
namespace {

std::vector<double> luminance_of(const ImageF& image) {
    std::vector<double> result;
    result.reserve(static_cast<std::size_t>(image.width()) * static_cast<std::size_t>(image.height()));
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            const float* p = image.pixel(x, y);
            result.push_back(luminance_rec709(p[0], p[1], p[2]));
        }
    }
    return result;
}

/// The luminance that half of the sphere does not reach.
double median_by_solid_angle(const std::vector<double>& luminance, const LatlongGrid& grid) {
    std::vector<std::size_t> order(luminance.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return luminance[a] < luminance[b]; });
    const auto width = static_cast<std::size_t>(grid.width());
    double half = 0;
    for (int y = 0; y < grid.height(); ++y) half += grid.solid_angle(y) * grid.width() / 2;
    for (const std::size_t index : order) {
        half -= grid.solid_angle(static_cast<int>(index / width));
        if (half <= 0) return luminance[index];
    }
    return luminance[order.back()];
}

class PeakGrowing {
public:
    PeakGrowing(const ImageF& image, const DominantLightOptions& options)
        : image_(image),
          options_(options),
          grid_(image.width(), image.height()),
          luminance_(luminance_of(image)),
          taken_(luminance_.size(), false) {}

    std::vector<DominantLight> run() {
        double total = 0;
        for (std::size_t i = 0; i < luminance_.size(); ++i) total += luminance_[i] * solid_angle(i);
        if (total <= 0) return {};
        floor_ = options_.least_peak_over_median * median_by_solid_angle(luminance_, grid_);

        std::vector<std::size_t> bright;
        for (std::size_t i = 0; i < luminance_.size(); ++i) {
            if (luminance_[i] > floor_) bright.push_back(i);
        }
        std::stable_sort(bright.begin(), bright.end(),
                         [&](std::size_t a, std::size_t b) { return luminance_[a] > luminance_[b]; });
        std::vector<DominantLight> lights;
        for (const std::size_t peak : bright) {
            if (taken_[peak]) continue;
            DominantLight light = grow(peak);
            light.power_share = luminance_rec709(light.power.x(), light.power.y(), light.power.z()) / total;
            if (light.power_share >= options_.least_power_share) lights.push_back(light);
        }
        std::stable_sort(lights.begin(), lights.end(),
                         [](const DominantLight& a, const DominantLight& b) { return a.power_share > b.power_share; });
        if (static_cast<int>(lights.size()) > options_.most) lights.resize(static_cast<std::size_t>(options_.most));
        return lights;
    }

private:
    double solid_angle(std::size_t index) const {
        return grid_.solid_angle(static_cast<int>(index / static_cast<std::size_t>(grid_.width())));
    }

    template <class Visit>
    void for_each_neighbour(std::size_t index, const Visit& visit) const {
        const int width = grid_.width();
        const int x = static_cast<int>(index % static_cast<std::size_t>(width));
        const int y = static_cast<int>(index / static_cast<std::size_t>(width));
        for (int dy = -1; dy <= 1; ++dy) {
            for (int dx = -1; dx <= 1; ++dx) {
                if ((dx == 0 && dy == 0) || y + dy < 0 || y + dy >= grid_.height()) continue;
                const int nx = (x + dx + width) % width;
                visit(static_cast<std::size_t>(y + dy) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(nx));
            }
        }
    }

    DominantLight grow(std::size_t peak) {
        DominantLight light;
        light.peak_luminance = luminance_[peak];
        const double edge = std::max(floor_, options_.edge_over_peak * luminance_[peak]);
        std::vector<std::size_t> members = {peak};
        std::vector<std::size_t> halo;
        taken_[peak] = true;
        Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
        for (std::size_t next = 0; next < members.size(); ++next) {
            const std::size_t index = members[next];
            const int x = static_cast<int>(index % static_cast<std::size_t>(grid_.width()));
            const int y = static_cast<int>(index / static_cast<std::size_t>(grid_.width()));
            const float* p = image_.pixel(x, y);
            light.solid_angle_sr += solid_angle(index);
            light.power += solid_angle(index) * Eigen::Vector3d(p[0], p[1], p[2]);
            const LatlongRow& row = grid_.row(y);
            const LatlongColumn& column = grid_.column(x);
            centroid += luminance_[index] * Eigen::Vector3d(row.sin2 * column.sine, row.sin2 * column.cosine,
                                                            row.sin1_cos1 * grid_.azimuth_step());
            for_each_neighbour(index, [&](std::size_t neighbour) {
                if (taken_[neighbour] || luminance_[neighbour] <= floor_) return;
                taken_[neighbour] = true;
                (luminance_[neighbour] >= edge ? members : halo).push_back(neighbour);
            });
        }
        // Downhill from the edge; noise may raise a pixel a little above its neighbour.
        constexpr double noise = 1.1;
        for (std::size_t next = 0; next < halo.size(); ++next) {
            const double limit = noise * luminance_[halo[next]];
            for_each_neighbour(halo[next], [&](std::size_t neighbour) {
                if (taken_[neighbour] || luminance_[neighbour] <= floor_ || luminance_[neighbour] > limit) return;
                taken_[neighbour] = true;
                halo.push_back(neighbour);
            });
        }
        if (centroid.norm() > 0) light.direction = centroid.normalized();
        return light;
    }

    const ImageF& image_;
    DominantLightOptions options_;
    LatlongGrid grid_;
    std::vector<double> luminance_;
    std::vector<bool> taken_;
    double floor_ = 0;
};

}  // namespace

std::vector<DominantLight> dominant_lights(const Probe& probe, const DominantLightOptions& options) {
    assert(!probe.latlong.empty() && probe.latlong.channels() == 3);
    return PeakGrowing(probe.latlong, options).run();
}

double ProbeStatistics::dynamic_range_ev() const {
    return least_positive_luminance > 0 ? std::log2(largest_luminance / least_positive_luminance) : 0;
}

ProbeStatistics probe_statistics(const Probe& probe) {
    const ImageF& image = probe.latlong;
    const LatlongGrid grid(image.width(), image.height());
    const std::vector<double> luminance = luminance_of(image);
    ProbeStatistics statistics;
    double sphere = 0;
    for (int y = 0; y < image.height(); ++y) {
        const double solid_angle = grid.solid_angle(y);
        for (int x = 0; x < image.width(); ++x) {
            const float* p = image.pixel(x, y);
            const double l = luminance_rec709(p[0], p[1], p[2]);
            statistics.mean_radiance += solid_angle * Eigen::Vector3d(p[0], p[1], p[2]);
            statistics.largest_luminance = std::max(statistics.largest_luminance, l);
            if (l <= 0) statistics.black_share += solid_angle;
            if (l > 0 && (statistics.least_positive_luminance == 0 || l < statistics.least_positive_luminance)) {
                statistics.least_positive_luminance = l;
            }
        }
        sphere += solid_angle * grid.width();
    }
    statistics.mean_radiance /= sphere;
    statistics.black_share /= sphere;
    const Eigen::Vector3d& mean = statistics.mean_radiance;
    statistics.mean_luminance = luminance_rec709(mean.x(), mean.y(), mean.z());
    statistics.median_luminance = median_by_solid_angle(luminance, grid);
    return statistics;
}

ImageF flat_tops(const ImageF& image) {
    const auto pixels = static_cast<std::size_t>(image.width()) * static_cast<std::size_t>(image.height());
    const auto channels = static_cast<std::size_t>(image.channels());
    ImageF clipped(image.width(), image.height(), 1);
    for (std::size_t c = 0; c < channels; ++c) {
        float largest = 0;
        double mean = 0;
        for (std::size_t i = 0; i < pixels; ++i) {
            largest = std::max(largest, image.samples()[i * channels + c]);
            mean += image.samples()[i * channels + c] / static_cast<double>(pixels);
        }
        std::vector<std::size_t> top;
        for (std::size_t i = 0; i < pixels; ++i) {
            if (image.samples()[i * channels + c] == largest) top.push_back(i);
        }
        if (top.size() < 4 || largest <= 0 || largest < 2 * mean) continue;
        for (const std::size_t i : top) clipped.samples()[i] = 1;
    }
    return clipped;
}

std::int64_t clipped_pixels(const ImageF& image) {
    const ImageF tops = flat_tops(image);
    return std::count(tops.samples().begin(), tops.samples().end(), 1.0f);
}

}  // namespace matchlight
