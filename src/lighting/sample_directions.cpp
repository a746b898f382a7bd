// A few directional lights that stand for a probe: median cut of the stratum whose shadow would err most.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "core/transfer.h"
#include "lighting/latlong_grid.h"
#include "lighting/probe.h"

namespace matchlight {
namespace {

/// Summed-area table of the power of pixels, in double: a sun of a million times the walls leaves them 10 digits.
class PowerTable {
public:
    PowerTable(const ImageF& image, const LatlongGrid& grid, double minimum_z, bool weight_by_cosine)
        : grid_(grid), stride_(static_cast<std::size_t>(image.width()) + 1) {
        // Rows below the limit hold nothing; the row that it cuts counts with the part above.
        while (rows_ < image.height() && grid.row_above(rows_, minimum_z).sin1 > 0) ++rows_;
        sums_.assign(stride_ * (static_cast<std::size_t>(rows_) + 1), 0.0);
        for (int y = 0; y < rows_; ++y) {
            const LatlongRow row = grid.row_above(y, minimum_z);
            double weight = row.sin1;
            if (weight_by_cosine) weight = std::max(0.0, row.sin1_cos1);
            double row_sum = 0;
            for (int x = 0; x < image.width(); ++x) {
                const float* p = image.pixel(x, y);
                row_sum += std::max(0.0, luminance_rec709(p[0], p[1], p[2])) * weight * grid.azimuth_step();
                at(x + 1, y + 1) = at(x + 1, y) + row_sum;
            }
        }
    }

    int rows() const { return rows_; }
    double power(const Region& r) const {
        const double sum =
            at(r.x + r.width, r.y + r.height) - at(r.x, r.y + r.height) - at(r.x + r.width, r.y) + at(r.x, r.y);
        return std::max(0.0, sum);
    }
    const LatlongGrid& grid() const { return grid_; }

private:
    double& at(int x, int y) { return sums_[static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(x)]; }
    double at(int x, int y) const { return sums_[static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(x)]; }

    const LatlongGrid& grid_;
    std::size_t stride_;
    int rows_ = 0;
    std::vector<double> sums_;
};

/// A region and how wrong a shadow is when one direction stands for it: the penumbra, as wide as the region's power is
/// spread, turns into an edge that moves all its power from one side to the other.
struct Stratum {
    Region region;
    double shadow_error = 0;                          // power · standard deviation of its direction, radians
    std::optional<std::pair<Region, Region>> halves;  // absent where it cannot be cut
};

/// Power along one axis of a region: its variance in steps of the axis, and the cut that halves it best.
struct AxisProfile {
    double variance = 0;
    int cut = 0;  // number of steps before the cut; 0 where the axis cannot be cut
};

AxisProfile profile(int steps, const auto& power_of_first) {
    AxisProfile result;
    const double total = power_of_first(steps);
    if (steps < 2 || total <= 0) return result;
    double before = 0;
    double mean = 0;
    double square = 0;
    double best_imbalance = 2 * total;
    for (int i = 0; i < steps; ++i) {
        const double through = power_of_first(i + 1);
        const double power = through - before;
        mean += power * i;
        square += power * i * i;
        before = through;
        const double imbalance = std::abs(2 * through - total);
        if (i + 1 < steps && imbalance < best_imbalance) {
            best_imbalance = imbalance;
            result.cut = i + 1;
        }
    }
    mean /= total;
    // One step is itself spread by 1/12 of its square.
    result.variance = std::max(0.0, square / total - mean * mean) + 1.0 / 12;
    return result;
}

/// Cuts at the median of power, across the axis along which power is spread wider over the sphere (Debevec 2005, A
/// Median Cut Algorithm for Light Probe Sampling, cuts the longer side of the region; the spread of power instead of
/// the region's size is the variance of Viriyothai & Debevec 2009, Variance Minimization Light Probe Sampling).
Stratum make_stratum(const PowerTable& table, const Region& r) {
    const AxisProfile across = profile(r.width, [&](int steps) { return table.power({r.x, r.y, steps, r.height}); });
    const AxisProfile down = profile(r.height, [&](int steps) { return table.power({r.x, r.y, r.width, steps}); });

    const LatlongGrid& grid = table.grid();
    const double middle = std::numbers::pi * (r.y + 0.5 * r.height) / grid.height();
    const double azimuth_scale = grid.azimuth_step() * std::sin(middle);
    const double polar_scale = std::numbers::pi / grid.height();
    const double across_variance = across.variance * azimuth_scale * azimuth_scale;
    const double down_variance = down.variance * polar_scale * polar_scale;
    Stratum stratum{r, table.power(r) * std::sqrt(across_variance + down_variance), std::nullopt};
    if (across.cut == 0 && down.cut == 0) return stratum;
    if (down.cut == 0 || (across.cut != 0 && across_variance >= down_variance)) {
        stratum.halves = {{r.x, r.y, across.cut, r.height}, {r.x + across.cut, r.y, r.width - across.cut, r.height}};
    } else {
        stratum.halves = {{r.x, r.y, r.width, down.cut}, {r.x, r.y + down.cut, r.width, r.height - down.cut}};
    }
    return stratum;
}

}  // namespace

std::vector<DirectionalSample> sample_directions(const Probe& probe, int count, double minimum_z,
                                                 bool weight_by_cosine) {
    const ImageF& image = probe.latlong;
    assert(!image.empty() && image.channels() == 3);
    const LatlongGrid grid(image.width(), image.height());
    const PowerTable table(image, grid, minimum_z, weight_by_cosine);
    if (table.rows() == 0 || count < 1) return {};

    // The stratum that errs most and can still be cut is cut next, so any count is met, not only powers of two: a lamp
    // narrower than its penumbra matters gets few of them, however strong. Ties fall to the older stratum, so the
    // result is the same everywhere.
    std::vector<Stratum> open;
    std::vector<Stratum> finished;
    open.push_back(make_stratum(table, {0, 0, image.width(), table.rows()}));
    while (!open.empty() && static_cast<int>(open.size() + finished.size()) < count) {
        const auto worst = std::max_element(open.begin(), open.end(), [](const Stratum& a, const Stratum& b) {
            return a.shadow_error < b.shadow_error;
        });
        if (!worst->halves) {
            finished.push_back(*worst);
            open.erase(worst);
            continue;
        }
        const auto [first, second] = *worst->halves;
        *worst = make_stratum(table, first);
        open.push_back(make_stratum(table, second));
    }
    finished.insert(finished.end(), open.begin(), open.end());

    std::vector<DirectionalSample> samples;
    samples.reserve(finished.size());
    for (const Stratum& stratum : finished) {
        const Region& r = stratum.region;
        Eigen::Vector3d integral = Eigen::Vector3d::Zero();
        Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
        double power = 0;
        double whole_solid_angle = 0;
        for (int y = r.y; y < r.y + r.height; ++y) {
            const LatlongRow row = grid.row_above(y, minimum_z);
            for (int x = r.x; x < r.x + r.width; ++x) {
                const float* p = image.pixel(x, y);
                const double luminance = std::max(0.0, luminance_rec709(p[0], p[1], p[2]));
                const double solid_angle = row.sin1 * grid.azimuth_step();
                whole_solid_angle += solid_angle;
                integral += solid_angle * Eigen::Vector3d(p[0], p[1], p[2]);
                power += luminance * solid_angle;
                centroid +=
                    luminance * Eigen::Vector3d(row.sin2 * grid.column(x).sine, row.sin2 * grid.column(x).cosine,
                                                row.sin1_cos1 * grid.azimuth_step());
            }
        }
        if (power <= 0) continue;  // a black stratum lights nothing
        DirectionalSample sample;
        sample.radiance_times_solid_angle = integral;
        sample.solid_angle_sr = whole_solid_angle;
        if (centroid.norm() > 0) sample.direction = centroid.normalized();
        if (weight_by_cosine) {
            // The mean cosine as the height, so that the irradiance of a level plane is the stratum's own; the
            // normalised centroid would stand too high by the spread of the stratum.
            const double z = std::clamp(centroid.z() / power, -1.0, 1.0);
            const double horizontal = std::hypot(centroid.x(), centroid.y());
            if (horizontal > 0) {
                const double scale = std::sqrt(1 - z * z) / horizontal;
                sample.direction = {centroid.x() * scale, centroid.y() * scale, z};
            }
        }
        samples.push_back(sample);
    }
    return samples;
}

}  // namespace matchlight
