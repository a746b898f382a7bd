// Sums over exact solid angles in double precision; both probes are brought to one size first.
#include "lighting/probe_comparison.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "core/transfer.h"
#include "lighting/dominant_lights.h"
#include "lighting/latlong_grid.h"
#include "lighting/resample.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;

using std::numbers::pi;
constexpr double degree = pi / 180;

/// Light this much under the mean is too little to be seen beside the rest, and to be told from a camera's noise.
constexpr double negligible = 1e-4;

double luminance_at(const ImageF& image, int x, int y) {
    const float* p = image.pixel(x, y);
    return luminance_rec709(p[0], p[1], p[2]);
}

double angle_between(const Vector3d& a, const Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

void scale(ImageF& image, const Vector3d& gain) {
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>(image.at(x, y, c) * gain[c]);
        }
    }
}

/// The gains that bring the test's irradiance nearest to the truth's.
Vector3d best_gain(const std::vector<Vector3d>& truth, const std::vector<Vector3d>& test, FreeGain free_gain) {
    if (free_gain == FreeGain::none) return Vector3d::Ones();
    Vector3d cross = Vector3d::Zero();
    Vector3d square = Vector3d::Zero();
    for (std::size_t i = 0; i < truth.size(); ++i) {
        cross += truth[i].cwiseProduct(test[i]);
        square += test[i].cwiseProduct(test[i]);
    }
    if (free_gain == FreeGain::common) {
        return square.sum() > 0 ? Vector3d::Constant(cross.sum() / square.sum()) : Vector3d::Ones();
    }
    Vector3d gain = Vector3d::Ones();
    for (int c = 0; c < 3; ++c) {
        if (square[c] > 0) gain[c] = cross[c] / square[c];
    }
    return gain;
}

void compare_irradiance(const std::vector<Vector3d>& truth, const std::vector<Vector3d>& test,
                        ProbeComparison& result) {
    double square = 0;
    double mean = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const Vector3d difference = test[i].cwiseProduct(result.gain) - truth[i];
        square += difference.squaredNorm();
        mean += truth[i].sum();
        result.worst_irradiance = std::max(result.worst_irradiance, difference.cwiseAbs().maxCoeff());
    }
    const double count = 3 * static_cast<double>(truth.size());
    mean /= count;
    if (mean <= 0) return;
    result.irradiance_rmse = std::sqrt(square / count) / mean;
    result.worst_irradiance /= mean;
}

/// Where the light points that rises above 0.3 of the largest luminance, once it is smoothed over the sphere: what
/// comes near that limit counts for next to nothing, so that a window does not jump in or out.
Vector3d brightest_direction(const Probe& probe) {
    const ImageF& image = probe.latlong;
    const LatlongGrid grid(image.width(), image.height());
    // Two pixels of a map of 128 rows: a lamp of one pixel is found as surely as one of several.
    constexpr double sigma = 2 * pi / 128;
    constexpr double reach = 3 * sigma;
    const int rows = static_cast<int>(std::ceil(reach / pi * image.height()));
    std::vector<double> smooth(static_cast<std::size_t>(image.width()) * static_cast<std::size_t>(image.height()));
    double largest = 0;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            const Vector3d here = latlong_direction(x, y, image.width(), image.height());
            double sum = 0;
            double weight_sum = 0;
            for (int row = std::max(0, y - rows); row <= std::min(image.height() - 1, y + rows); ++row) {
                const double sine = std::sin(pi * (row + 0.5) / image.height());
                const int most = image.width() / 2;
                const int columns =
                    std::min(most, static_cast<int>(std::ceil(reach / grid.azimuth_step() / std::max(sine, 1e-6))));
                for (int offset = -columns; offset < columns + (columns < most ? 1 : 0); ++offset) {
                    const int column = (x + offset + image.width()) % image.width();
                    const double cosine = here.dot(latlong_direction(column, row, image.width(), image.height()));
                    if (cosine < std::cos(reach)) continue;
                    const double angle = std::acos(std::min(1.0, cosine));
                    const double weight = std::exp(-angle * angle / (2 * sigma * sigma)) * grid.solid_angle(row);
                    sum += weight * luminance_at(image, column, row);
                    weight_sum += weight;
                }
            }
            const double mean = sum / weight_sum;
            smooth[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width()) +
                   static_cast<std::size_t>(x)] = mean;
            largest = std::max(largest, mean);
        }
    }
    Vector3d direction = Vector3d::Zero();
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            const double value = smooth[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width()) +
                                        static_cast<std::size_t>(x)];
            const double above = value - 0.3 * largest;
            if (above <= 0) continue;
            direction += above * grid.solid_angle(y) * latlong_direction(x, y, image.width(), image.height());
        }
    }
    return direction;
}

struct Weighted {
    double value = 0;
    double weight = 0;
};

/// The value that this share of the weight does not pass.
double quantile(std::vector<Weighted> values, double share) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end(), [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
    double left = 0;
    for (const Weighted& each : values) left += share * each.weight;
    for (const Weighted& each : values) {
        left -= each.weight;
        if (left <= 0) return each.value;
    }
    return values.back().value;
}

void compare_pixels(const ImageF& truth, const ImageF& test, ProbeComparison& result) {
    const LatlongGrid grid(truth.width(), truth.height());
    double mean = 0;
    for (int y = 0; y < truth.height(); ++y) {
        for (int x = 0; x < truth.width(); ++x) mean += luminance_at(truth, x, y) * grid.solid_angle(y) / (4 * pi);
    }
    std::vector<Weighted> errors;
    double weight = 0;
    for (int y = 0; y < truth.height(); ++y) {
        for (int x = 0; x < truth.width(); ++x) {
            const double expected = luminance_at(truth, x, y);
            const double found = luminance_at(test, x, y);
            if (expected <= negligible * mean) continue;
            if (found <= 0) {
                result.black_share += grid.solid_angle(y) / (4 * pi);
                continue;
            }
            const double ev = std::log2(found / expected);
            errors.push_back({std::abs(ev), grid.solid_angle(y)});
            result.mean_ev += ev * grid.solid_angle(y);
            weight += grid.solid_angle(y);
        }
    }
    if (weight > 0) result.mean_ev /= weight;
    result.median_abs_ev = quantile(errors, 0.5);
    result.percentile_95_abs_ev = quantile(errors, 0.95);
}

/// The mirror ball shows every direction with the same solid angle a pixel.
void compare_balls(const Probe& truth, const Probe& test, ProbeComparison& result) {
    const ProbeLayout layout = layout_of_size(ProbeMapping::mirrorball, result.ball_px);
    const ImageF expected = image_from_probe(truth, layout);
    const ImageF found = image_from_probe(test, layout);
    const std::vector<double> solid_angles = pixel_solid_angles(layout);
    double mean = 0;
    for (int y = 0; y < layout.height; ++y) {
        for (int x = 0; x < layout.width; ++x) {
            mean += luminance_at(expected, x, y) *
                    solid_angles[static_cast<std::size_t>(y) * static_cast<std::size_t>(layout.width) +
                                 static_cast<std::size_t>(x)] /
                    (4 * pi);
        }
    }
    if (mean <= 0) return;
    std::vector<Weighted> errors;
    double square = 0;
    for (int y = 0; y < layout.height; ++y) {
        for (int x = 0; x < layout.width; ++x) {
            if (!direction_from_pixel(layout, Eigen::Vector2d(x, y))) continue;
            const auto seen = [&](const ImageF& ball) { return std::max(luminance_at(ball, x, y), negligible * mean); };
            const double ev = std::log2(seen(found) / seen(expected));
            square += ev * ev;
            errors.push_back({std::abs(ev), 1});
        }
    }
    result.ball_rms_ev = std::sqrt(square / static_cast<double>(errors.size()));
    result.ball_median_abs_ev = quantile(errors, 0.5);
}

struct ConeFlux {
    double power = 0;
    Vector3d direction = Vector3d::Zero();
};

/// The luminance within `radius` of `axis` above the median of a ring around it, which other lamps may stand in.
ConeFlux flux_above_surroundings(const Probe& probe, const Vector3d& axis, double radius) {
    const ImageF& image = probe.latlong;
    const LatlongGrid grid(image.width(), image.height());
    std::vector<Weighted> ring;
    double cone = 0;
    double cone_solid_angle = 0;
    Vector3d centroid = Vector3d::Zero();
    Vector3d even_centroid = Vector3d::Zero();
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            const Vector3d direction = latlong_direction(x, y, image.width(), image.height());
            const double angle = angle_between(direction, axis);
            if (angle > 1.5 * radius) continue;
            const double luminance = luminance_at(image, x, y);
            const double solid_angle = grid.solid_angle(y);
            if (angle > radius) {
                ring.push_back({luminance, solid_angle});
            } else {
                cone += luminance * solid_angle;
                cone_solid_angle += solid_angle;
                centroid += luminance * solid_angle * direction;
                even_centroid += solid_angle * direction;
            }
        }
    }
    const double surroundings = quantile(ring, 0.5);
    return {cone - surroundings * cone_solid_angle, centroid - surroundings * even_centroid};
}

std::vector<ComparedLight> compare_lights(const Probe& truth, const Probe& test) {
    std::vector<ComparedLight> result;
    const double pixel = pi / std::min(truth.latlong.height(), test.latlong.height());
    for (const DominantLight& light : dominant_lights(truth)) {
        // Half as wide again as a disc of its size, and room for the blur of either map and for a light astray by 2°.
        const double radius = 1.5 * std::sqrt(light.solid_angle_sr / pi) + 2 * pixel + 2 * degree;
        const ConeFlux expected = flux_above_surroundings(truth, light.direction, radius);
        const ConeFlux found = flux_above_surroundings(test, light.direction, radius);
        if (expected.power <= 0) continue;
        ComparedLight compared;
        compared.direction = light.direction;
        compared.power_share = light.power_share;
        compared.solid_angle_sr = light.solid_angle_sr;
        compared.angle_deg = angle_between(expected.direction, found.direction) / degree;
        compared.power_ev = std::log2(std::max(found.power, 1e-6 * expected.power) / expected.power);
        result.push_back(compared);
    }
    return result;
}

}  // namespace

std::vector<Vector3d> even_directions(int count) {
    std::vector<Vector3d> directions;
    directions.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        const double z = 1 - (2 * i + 1.0) / count;
        const double azimuth = 2 * pi * i / std::numbers::phi;
        const double across = std::sqrt(1 - z * z);
        directions.emplace_back(across * std::cos(azimuth), across * std::sin(azimuth), z);
    }
    return directions;
}

ProbeComparison compare_probes(const Probe& truth, const Probe& test, const ProbeComparisonOptions& options) {
    assert(!truth.latlong.empty() && !test.latlong.empty());
    ProbeComparison result;
    const int both_height = std::min(truth.latlong.height(), test.latlong.height());
    // Irradiance, directions and the median need no more than 1.4° a pixel; lamps are measured at full size.
    const int height = std::min(128, both_height);
    const Probe small_truth = resized(truth, height);
    Probe small_test = resized(test, height);

    std::vector<Vector3d> expected;
    std::vector<Vector3d> found;
    for (const Vector3d& normal : even_directions(400)) {
        expected.push_back(irradiance(small_truth, normal));
        found.push_back(irradiance(small_test, normal));
    }
    result.gain = best_gain(expected, found, options.free_gain);
    compare_irradiance(expected, found, result);

    scale(small_test.latlong, result.gain);
    result.brightest_angle_deg =
        angle_between(brightest_direction(small_truth), brightest_direction(small_test)) / degree;
    compare_pixels(small_truth.latlong, small_test.latlong, result);

    Probe scaled = test;
    scale(scaled.latlong, result.gain);
    result.lights = compare_lights(truth, scaled);
    result.ball_px =
        options.ball_px > 0 ? options.ball_px : std::min(512, size_for_latlong(ProbeMapping::mirrorball, both_height));
    compare_balls(truth, scaled, result);
    return result;
}

}  // namespace matchlight
