// The overlaps of pixels are balanced until both images' solid angles hold.
#include "lighting/resample.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "lighting/latlong_pyramid.h"
#include "lighting/pixel_overlaps.h"

namespace matchlight {
namespace {

/// Gains of source pixels, so that each hands out its own solid angle while every target pixel receives its own.
/// Target pixels are scaled last: uniform light stays uniform exactly, and what a lamp of one pixel gains or loses is
/// what the source pixels' sums still lack.
class Balance {
public:
    Balance(const PixelOverlaps& overlaps, const ResampleOptions& options)
        : overlaps_(overlaps),
          options_(options),
          solid_angles_(overlaps.from_solid_angles()),
          gain_(solid_angles_.size(), 1.0f) {}

    std::vector<float> run() {
        // A matrix that is not kept costs as much to make again as all passes over one that is.
        const int most = overlaps_.kept() ? options_.most_passes : std::min(options_.most_passes, 2);
        // Sinkhorn & Knopp 1967, Concerning Nonnegative Matrices and Doubly Stochastic Matrices: a few of their rounds
        // take away what is uneven between neighbours. What interpolation gives a pole or a cube's edge too much must
        // travel over the whole map, for which hundreds would be needed: Newton's method with conjugate gradients
        // (Knight & Ruiz 2013, A Fast Algorithm for Matrix Balancing) gets it there.
        constexpr int sinkhorn_rounds = 4;
        while (passes_ < most) {
            const std::vector<float> handed_out = overlaps_.handed_out(gain_);
            ++passes_;
            const double worst = largest_lack(handed_out);
            if (passes_ <= sinkhorn_rounds || passes_ == most) {
                for (std::size_t i = 0; i < gain_.size(); ++i) {
                    if (handed_out[i] > 0) gain_[i] *= static_cast<float>(solid_angles_[i] / handed_out[i]);
                }
            } else if (worst > options_.energy_tolerance) {
                take_newton_step(handed_out, std::max(0.5 * options_.energy_tolerance, 0.05 * worst), most);
            }
            if (worst <= options_.energy_tolerance) break;
        }
        return gain_;
    }

private:
    double largest_lack(const std::vector<float>& handed_out) const {
        double worst = 0;
        for (std::size_t i = 0; i < gain_.size(); ++i) {
            if (handed_out[i] > 0) worst = std::max(worst, std::abs(solid_angles_[i] / handed_out[i] - 1));
        }
        return worst;
    }

    /// What a preconditioner makes of the lack: each pixel's own, and that of its group, which carries over the map.
    std::vector<double> preconditioned(const std::vector<double>& lack) const {
        Eigen::VectorXd of_group = Eigen::VectorXd::Zero(group_solid_angles_.size());
        for (std::size_t i = 0; i < lack.size(); ++i) of_group[group_of_[i]] += lack[i];
        // All gains together have no effect, and all lacks together are rounding: neither has a say.
        const double sphere = group_solid_angles_.sum();
        of_group -= of_group.sum() / sphere * group_solid_angles_;
        of_group = between_groups_.solve(of_group);
        of_group.array() -= of_group.dot(group_solid_angles_) / sphere;
        std::vector<double> result(lack.size(), 0.0);
        for (std::size_t i = 0; i < lack.size(); ++i) {
            if (solid_angles_[i] > 0) result[i] = lack[i] / solid_angles_[i] + of_group[group_of_[i]];
        }
        return result;
    }

    /// Groups are the pixels of a coarse cube map; the matrix between them is that of the first Newton step, near
    /// enough for the later ones.
    void make_groups() {
        const ProbeLayout cube = layout_of_size(ProbeMapping::cube, 12, CubeLayout::strip);
        constexpr int groups = 6 * 12 * 12;
        group_of_.assign(solid_angles_.size(), 0);
        group_solid_angles_ = Eigen::VectorXd::Zero(groups);
        const ProbeLayout& from = overlaps_.from();
        for (int y = 0; y < from.height; ++y) {
            for (int x = 0; x < from.width; ++x) {
                const auto direction = direction_from_pixel(from, Eigen::Vector2d(x, y));
                if (!direction) continue;
                const Eigen::Vector2i cell = nearest_pixel(cube, *direction);
                const std::size_t pixel =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(from.width) + static_cast<std::size_t>(x);
                group_of_[pixel] = static_cast<std::uint16_t>(cell.y() * cube.width + cell.x());
                group_solid_angles_[group_of_[pixel]] += solid_angles_[pixel];
            }
        }
        Eigen::MatrixXd matrix = overlaps_.change_between_groups(gain_, group_of_, groups);
        ++passes_;
        // Regular for all gains together, and for groups without pixels.
        matrix.diagonal().array() += 1e-6 * matrix.trace() / groups;
        between_groups_.compute(matrix);
    }

    /// Conjugate gradients, preconditioned on two levels, until no pixel lacks more than `tolerance` of its own.
    void take_newton_step(const std::vector<float>& handed_out, double tolerance, int most) {
        if (group_of_.empty()) make_groups();
        const std::size_t count = gain_.size();
        std::vector<double> lack(count, 0.0), step(count, 0.0);
        for (std::size_t i = 0; i < count; ++i) {
            if (handed_out[i] > 0) lack[i] = solid_angles_[i] - handed_out[i];
        }
        std::vector<double> cure = preconditioned(lack);
        std::vector<float> direction(cure.begin(), cure.end());
        double energy = std::inner_product(lack.begin(), lack.end(), cure.begin(), 0.0);
        while (passes_ < most - 1 && energy > 0) {
            const std::vector<float> change = overlaps_.change_handed_out(gain_, direction);
            ++passes_;
            const double curvature = std::inner_product(change.begin(), change.end(), direction.begin(), 0.0);
            if (curvature <= 0) break;
            const double length = energy / curvature;
            double worst = 0;
            for (std::size_t i = 0; i < count; ++i) {
                if (handed_out[i] <= 0) continue;
                step[i] += length * direction[i];
                lack[i] -= length * change[i];
                worst = std::max(worst, std::abs(lack[i]) / solid_angles_[i]);
            }
            if (worst <= tolerance) break;
            cure = preconditioned(lack);
            const double next_energy = std::inner_product(lack.begin(), lack.end(), cure.begin(), 0.0);
            const double turn = next_energy / energy;
            energy = next_energy;
            for (std::size_t i = 0; i < count; ++i) direction[i] = static_cast<float>(cure[i] + turn * direction[i]);
        }
        for (std::size_t i = 0; i < count; ++i) gain_[i] *= static_cast<float>(std::exp(step[i]));
    }

    const PixelOverlaps& overlaps_;
    ResampleOptions options_;
    const std::vector<double>& solid_angles_;
    std::vector<float> gain_;
    std::vector<std::uint16_t> group_of_;  // of every source pixel
    Eigen::VectorXd group_solid_angles_;
    Eigen::LDLT<Eigen::MatrixXd> between_groups_;
    int passes_ = 0;
};

/// Pixels of a disc whose centre lies outside show what the nearest one inside shows, for programs that interpolate.
void fill_rim(ImageF& image, const ProbeLayout& layout) {
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            const Eigen::Vector2d centre((layout.width - 1) / 2.0, (layout.height - 1) / 2.0);
            if (direction_from_pixel(layout, Eigen::Vector2d(x, y))) continue;
            // The corner nearest to the centre is inside where the disc cuts the pixel.
            const Eigen::Vector2d corner(x + (x < centre.x() ? 0.5 : -0.5), y + (y < centre.y() ? 0.5 : -0.5));
            const auto direction = direction_from_pixel(layout, corner);
            if (!direction) continue;
            const Eigen::Vector2i inside = nearest_pixel(layout, *direction);
            std::copy_n(image.pixel(inside.x(), inside.y()), image.channels(), image.pixel(x, y));
        }
    }
}

}  // namespace

ImageF resample(const ImageF& source, const ProbeLayout& from, const ProbeLayout& to, const ResampleOptions& options) {
    assert(source.width() == from.width && source.height() == from.height);
    if (from == to) return source;
    const bool latlong_both = from.mapping == ProbeMapping::latlong && to.mapping == ProbeMapping::latlong;
    if (latlong_both && !from.edge_centred && !to.edge_centred && to.width <= from.width && to.height <= from.height) {
        return shrunk_latlong(source, to.width, to.height);
    }
    const int channels = source.channels();
    assert(channels <= 4);
    const PixelOverlaps overlaps(from, to, options.points_a_side);
    const std::vector<float> gain = Balance(overlaps, options).run();

    ImageF result(to.width, to.height, channels);
    overlaps.for_each_pixel([&](int, std::uint32_t target, std::span<const PixelOverlap> row) {
        double received = 0;
        std::array<double, 4> flux{};
        for (const PixelOverlap& overlap : row) {
            const double weight = static_cast<double>(overlap.solid_angle) * gain[overlap.source];
            received += weight;
            const float* pixel =
                source.samples().data() + std::size_t{overlap.source} * static_cast<std::size_t>(channels);
            for (int c = 0; c < channels; ++c) flux[static_cast<std::size_t>(c)] += weight * pixel[c];
        }
        if (received <= 0) return;
        float* pixel = result.samples().data() + std::size_t{target} * static_cast<std::size_t>(channels);
        for (int c = 0; c < channels; ++c) {
            pixel[c] = static_cast<float>(flux[static_cast<std::size_t>(c)] / received);
        }
    });
    if (is_disc(to.mapping)) fill_rim(result, to);
    return result;
}

ImageF image_from_probe(const Probe& probe, const ProbeLayout& to) {
    return resample(probe.latlong, layout_of_size(ProbeMapping::latlong, probe.latlong.height()), to);
}

Probe probe_from_image(const ImageF& image, const ProbeLayout& from, int height) {
    return {resample(image, from, layout_of_size(ProbeMapping::latlong, height))};
}

Probe resized(const Probe& probe, int height) {
    if (probe.latlong.height() == height) return probe;
    return probe_from_image(probe.latlong, layout_of_size(ProbeMapping::latlong, probe.latlong.height()), height);
}

int latlong_height_for(const ProbeLayout& layout) {
    // Equal pixels a radian in the middle of the image, where the layout is finest for its solid angle.
    switch (layout.mapping) {
        case ProbeMapping::latlong:
            return layout.height;
        case ProbeMapping::angular:
            return std::max(1, (layout.width + 1) / 2);  // width / 2π pixels a radian
        case ProbeMapping::mirrorball:                   // width / 4
            return std::max(1, static_cast<int>(std::lround(std::numbers::pi * layout.width / 4)));
        case ProbeMapping::cube:
            return 2 * layout.face_size();  // the mean over the face, 4 faces around
    }
    assert(false);
    return layout.height;
}

int size_for_latlong(ProbeMapping to, int latlong_height) {
    switch (to) {
        case ProbeMapping::latlong:
            return latlong_height;
        case ProbeMapping::angular:
            return 2 * latlong_height;
        case ProbeMapping::mirrorball:
            return std::max(1, static_cast<int>(std::lround(latlong_height * 4 / std::numbers::pi)));
        case ProbeMapping::cube:
            return std::max(1, (latlong_height + 1) / 2);
    }
    assert(false);
    return latlong_height;
}

}  // namespace matchlight
