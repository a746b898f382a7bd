// Overlaps of pixels are estimated on lattices of points and then balanced until both images' solid angles hold.
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

#include "core/parallel.h"
#include "lighting/latlong_pyramid.h"

namespace matchlight {
namespace {

/// Pixels that show a direction.
double pixels_on_sphere(const ProbeLayout& layout) {
    const double all = static_cast<double>(layout.width) * layout.height;
    switch (layout.mapping) {
        case ProbeMapping::latlong:
            return all * 2 / std::numbers::pi;  // the poles are crowded
        case ProbeMapping::angular:
        case ProbeMapping::mirrorball:
            return all * std::numbers::pi / 4;
        case ProbeMapping::cube:
            return 6.0 * layout.face_size() * layout.face_size();
    }
    assert(false);
    return all;
}

/// A source pixel's share in a target pixel.
struct Overlap {
    std::uint32_t source;
    float solid_angle;
};

/// A share that the lattice of points missed.
struct MissedOverlap {
    std::uint32_t target;
    Overlap overlap;
};

/// The matrix of solid angles that target pixels share with source pixels.
class Overlaps {
public:
    Overlaps(const ProbeLayout& from, const ProbeLayout& to, const ResampleOptions& options)
        : from_(from), to_(to), from_solid_angles_(pixel_solid_angles(from)), to_solid_angles_(pixel_solid_angles(to)) {
        // At least so many points a side to a pixel of the finer image; 32 are enough to shrink a map by more than ten
        // a side, because what they miss of single pixels is put right by scattering and by the balance.
        const double ratio = std::sqrt(pixels_on_sphere(from) / pixels_on_sphere(to));
        points_ = std::clamp(static_cast<int>(std::ceil(options.points_a_side * ratio)), options.points_a_side + 1, 32);
        // Kept where it fits in some 300 MB, made anew for every pass where not.
        const std::int64_t entries = static_cast<std::int64_t>(to.width) * to.height * 12 +
                                     static_cast<std::int64_t>(from.width) * from.height * 4;
        kept_ = entries * static_cast<std::int64_t>(sizeof(Overlap)) < (std::int64_t{300} << 20);
        // Four bands of rows keep four cores busy; each sums for itself and the bands are added in their order, so that
        // results do not depend on the number of threads. Their sums cost 16 bytes a source pixel, too much for the
        // largest maps.
        bands_ = static_cast<std::int64_t>(from.width) * from.height < (1 << 25) ? 4 : 1;
        first_missed_.assign(static_cast<std::size_t>(to.height) + 1, 0);
        if (kept_) {
            rows_.resize(static_cast<std::size_t>(to.height));
            parallel_for(to.height, [&](int y) { rows_[static_cast<std::size_t>(y)] = make_row(y); });
        }
        scatter_missed();
        if (kept_) {
            parallel_for(to.height, [&](int y) { add_missed(y, rows_[static_cast<std::size_t>(y)]); });
        }
    }

    bool kept() const { return kept_; }
    const ProbeLayout& from() const { return from_; }
    const std::vector<double>& from_solid_angles() const { return from_solid_angles_; }

    /// Calls body(band, target, overlaps) for every target pixel; calls of one band come in order, on one thread.
    template <class Body>
    void for_each_pixel(const Body& body) const {
        parallel_for(bands_, [&](int band) {
            for (int y = first_row(band); y < first_row(band + 1); ++y) {
                Row made;
                if (!kept_) {
                    made = make_row(y);
                    add_missed(y, made);
                }
                const Row& row = kept_ ? rows_[static_cast<std::size_t>(y)] : made;
                for (int x = 0; x < to_.width; ++x) {
                    const std::size_t first = row.first[static_cast<std::size_t>(x)];
                    const std::size_t last = row.first[static_cast<std::size_t>(x) + 1];
                    body(band, index_in(to_, x, y), std::span(row.entries).subspan(first, last - first));
                }
            }
        });
    }

    /// What every source pixel hands out in all with these gains, when every target pixel is scaled to receive its own
    /// solid angle.
    std::vector<float> handed_out(const std::vector<float>& source_gain) const {
        return sums_of_sources([&](std::uint32_t target, std::span<const Overlap> overlaps, std::vector<float>& sums) {
            double received = 0;
            for (const Overlap& overlap : overlaps) {
                received += static_cast<double>(overlap.solid_angle) * source_gain[overlap.source];
            }
            if (received <= 0) return;
            const auto target_gain = static_cast<float>(to_solid_angles_[target] / received);
            for (const Overlap& overlap : overlaps) {
                sums[overlap.source] += overlap.solid_angle * source_gain[overlap.source] * target_gain;
            }
        });
    }

    /// How handed_out() changes with the logarithms of the gains, in this direction.
    std::vector<float> change_handed_out(const std::vector<float>& source_gain,
                                         const std::vector<float>& direction) const {
        return sums_of_sources([&](std::uint32_t target, std::span<const Overlap> overlaps, std::vector<float>& sums) {
            double received = 0;
            double mean = 0;
            for (const Overlap& overlap : overlaps) {
                const double share = static_cast<double>(overlap.solid_angle) * source_gain[overlap.source];
                received += share;
                mean += share * direction[overlap.source];
            }
            if (received <= 0) return;
            mean /= received;
            const double target_gain = to_solid_angles_[target] / received;
            for (const Overlap& overlap : overlaps) {
                sums[overlap.source] += static_cast<float>(overlap.solid_angle * source_gain[overlap.source] *
                                                           target_gain * (direction[overlap.source] - mean));
            }
        });
    }

    /// The matrix of change_handed_out() between groups of source pixels.
    Eigen::MatrixXd change_between_groups(const std::vector<float>& source_gain,
                                          const std::vector<std::uint16_t>& group_of, int groups) const {
        std::vector<Eigen::MatrixXd> parts(static_cast<std::size_t>(bands_), Eigen::MatrixXd::Zero(groups, groups));
        std::vector<std::vector<std::pair<std::uint16_t, double>>> shares(static_cast<std::size_t>(bands_));
        for_each_pixel([&](int band, std::uint32_t target, std::span<const Overlap> overlaps) {
            auto& met = shares[static_cast<std::size_t>(band)];
            met.clear();
            double received = 0;
            for (const Overlap& overlap : overlaps) {
                const double share = static_cast<double>(overlap.solid_angle) * source_gain[overlap.source];
                const std::uint16_t group = group_of[overlap.source];
                const auto known =
                    std::find_if(met.begin(), met.end(), [&](const auto& m) { return m.first == group; });
                if (known != met.end()) {
                    known->second += share;
                } else {
                    met.emplace_back(group, share);
                }
                received += share;
            }
            if (met.size() < 2) return;  // what it moves, it moves within the group
            const double target_gain = to_solid_angles_[target] / received;
            Eigen::MatrixXd& part = parts[static_cast<std::size_t>(band)];
            for (const auto& [row, row_share] : met) {
                part(row, row) += target_gain * row_share;
                for (const auto& [column, column_share] : met) {
                    part(row, column) -= target_gain * row_share * column_share / received;
                }
            }
        });
        for (std::size_t part = 1; part < parts.size(); ++part) parts[0] += parts[part];
        return std::move(parts[0]);
    }

private:
    struct Row {
        std::vector<std::size_t> first;  // per target pixel, one more at the end
        std::vector<Overlap> entries;
    };

    static std::uint32_t index_in(const ProbeLayout& layout, int x, int y) {
        return static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(layout.width) + static_cast<std::uint32_t>(x);
    }

    int first_row(int band) const { return static_cast<int>(static_cast<std::int64_t>(to_.height) * band / bands_); }

    template <class Add>
    std::vector<float> sums_of_sources(const Add& add) const {
        const std::size_t source_pixels = from_solid_angles_.size();
        std::vector<std::vector<float>> parts(static_cast<std::size_t>(bands_),
                                              std::vector<float>(source_pixels, 0.0f));
        for_each_pixel([&](int band, std::uint32_t target, std::span<const Overlap> overlaps) {
            add(target, overlaps, parts[static_cast<std::size_t>(band)]);
        });
        for (std::size_t part = 1; part < parts.size(); ++part) {
            for (std::size_t i = 0; i < source_pixels; ++i) parts[0][i] += parts[part][i];
        }
        return std::move(parts[0]);
    }

    /// On a disc, what lies in a pixel whose centre is outside counts for the nearest one inside: nobody reads the
    /// pixel itself.
    bool is_read(int x, int y) const {
        return x >= 0 && y >= 0 && x < to_.width && y < to_.height && to_solid_angles_[index_in(to_, x, y)] > 0;
    }

    Row make_row(int y) const {
        Row row;
        row.first.reserve(static_cast<std::size_t>(to_.width) + 1);
        row.first.push_back(0);
        for (int x = 0; x < to_.width; ++x) {
            const std::size_t first = row.first.back();
            if (is_read(x, y)) {
                add_points(x, y, first, row.entries);
                if (is_disc(to_.mapping)) add_points_beyond(x, y, first, row.entries);
            }
            row.first.push_back(row.entries.size());
        }
        return row;
    }

    Eigen::Vector2d lattice_point(int x, int y, int i, int j) const {
        return {x + (i + 0.5) / points_ - 0.5, y + (j + 0.5) / points_ - 0.5};
    }

    void add_points(int x, int y, std::size_t first, std::vector<Overlap>& entries) const {
        for (int j = 0; j < points_; ++j) {
            for (int i = 0; i < points_; ++i) add_point(lattice_point(x, y, i, j), first, entries);
        }
    }

    /// The points of neighbours that nobody reads, where this pixel is the nearest.
    void add_points_beyond(int x, int y, std::size_t first, std::vector<Overlap>& entries) const {
        for (int neighbour = 0; neighbour < 9; ++neighbour) {
            const int nx = x + neighbour % 3 - 1, ny = y + neighbour / 3 - 1;
            if (nx < 0 || ny < 0 || nx >= to_.width || ny >= to_.height || is_read(nx, ny)) continue;
            for (int j = 0; j < points_; ++j) {
                for (int i = 0; i < points_; ++i) {
                    const Eigen::Vector2d point = lattice_point(nx, ny, i, j);
                    const auto direction = direction_from_pixel(to_, point);
                    if (direction && nearest_pixel(to_, *direction) == Eigen::Vector2i(x, y)) {
                        add_point(point, first, entries);
                    }
                }
            }
        }
    }

    /// Shares the solid angle at a point of the target among the four source pixels around it, adding to those that
    /// the target pixel (entries from `first` on) already has.
    void add_point(const Eigen::Vector2d& point, std::size_t first, std::vector<Overlap>& entries) const {
        const double solid_angle = solid_angle_density(to_, point) / (points_ * points_);
        if (solid_angle <= 0) return;
        for (const PixelTap& tap : bilinear_taps(from_, *direction_from_pixel(to_, point))) {
            if (tap.weight <= 0) continue;
            const std::uint32_t source = index_in(from_, tap.x, tap.y);
            const auto share = static_cast<float>(solid_angle * tap.weight);
            // Neighbouring points meet the same pixels: the latest entries are the likeliest.
            std::size_t known = entries.size();
            const std::size_t oldest = std::max(first, known > 64 ? known - 64 : 0);
            while (known > oldest && entries[known - 1].source != source) --known;
            if (known > oldest) {
                entries[known - 1].solid_angle += share;
            } else {
                entries.push_back({source, share});
            }
        }
    }

    /// Source pixels much smaller than the target's (at the pole of a lat-long map, behind a mirror ball) fall between
    /// the points. What they have not handed out goes where they lie, from points of their own.
    void scatter_missed() {
        const std::vector<float> gathered =
            sums_of_sources([](std::uint32_t, std::span<const Overlap> overlaps, std::vector<float>& sums) {
                for (const Overlap& overlap : overlaps) sums[overlap.source] += overlap.solid_angle;
            });
        // Less is noise of the lattice, which the balance takes away.
        constexpr double noise = 0.02;
        constexpr int points = 4;
        for (int y = 0; y < from_.height; ++y) {
            for (int x = 0; x < from_.width; ++x) {
                const std::uint32_t source = index_in(from_, x, y);
                const double missed = from_solid_angles_[source] - gathered[source];
                if (missed <= noise * from_solid_angles_[source]) continue;
                std::array<std::uint32_t, points * points> targets{};
                std::size_t count = 0;
                for (int i = 0; i < points * points; ++i) {
                    const Eigen::Vector2d point(x + (i % points + 0.5) / points - 0.5,
                                                y + (i / points + 0.5) / points - 0.5);
                    if (solid_angle_density(from_, point) <= 0) continue;
                    const Eigen::Vector2i target = nearest_pixel(to_, *direction_from_pixel(from_, point));
                    targets.at(count++) = index_in(to_, target.x(), target.y());
                }
                for (std::size_t i = 0; i < count; ++i) {
                    missed_.push_back(
                        {targets.at(i), {source, static_cast<float>(missed / static_cast<double>(count))}});
                }
            }
        }
        std::stable_sort(missed_.begin(), missed_.end(),
                         [](const MissedOverlap& a, const MissedOverlap& b) { return a.target < b.target; });
        for (int y = 0; y <= to_.height; ++y) {
            const auto begins = std::lower_bound(
                missed_.begin(), missed_.end(), static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(to_.width),
                [](const MissedOverlap& missed, std::uint64_t target) { return missed.target < target; });
            first_missed_[static_cast<std::size_t>(y)] = static_cast<std::size_t>(begins - missed_.begin());
        }
    }

    void add_missed(int y, Row& row) const {
        std::size_t next = first_missed_[static_cast<std::size_t>(y)];
        const std::size_t last = first_missed_[static_cast<std::size_t>(y) + 1];
        if (next == last) return;
        Row whole;
        whole.first.reserve(row.first.size());
        whole.first.push_back(0);
        for (int x = 0; x < to_.width; ++x) {
            whole.entries.insert(
                whole.entries.end(),
                row.entries.begin() + static_cast<std::ptrdiff_t>(row.first[static_cast<std::size_t>(x)]),
                row.entries.begin() + static_cast<std::ptrdiff_t>(row.first[static_cast<std::size_t>(x) + 1]));
            for (; next < last && missed_[next].target == index_in(to_, x, y); ++next) {
                whole.entries.push_back(missed_[next].overlap);
            }
            whole.first.push_back(whole.entries.size());
        }
        row = std::move(whole);
    }

    ProbeLayout from_, to_;
    std::vector<double> from_solid_angles_, to_solid_angles_;
    int points_ = 4;
    int bands_ = 1;
    bool kept_ = false;
    std::vector<Row> rows_;
    std::vector<MissedOverlap> missed_;      // by target
    std::vector<std::size_t> first_missed_;  // of every row of the target, one more at the end
};

/// Gains of source pixels, so that each hands out its own solid angle while every target pixel receives its own.
/// Target pixels are scaled last: uniform light stays uniform exactly, and what a lamp of one pixel gains or loses is
/// what the source pixels' sums still lack.
class Balance {
public:
    Balance(const Overlaps& overlaps, const ResampleOptions& options)
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

    const Overlaps& overlaps_;
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
    const Overlaps overlaps(from, to, options);
    const std::vector<float> gain = Balance(overlaps, options).run();

    ImageF result(to.width, to.height, channels);
    overlaps.for_each_pixel([&](int, std::uint32_t target, std::span<const Overlap> row) {
        double received = 0;
        std::array<double, 4> flux{};
        for (const Overlap& overlap : row) {
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
