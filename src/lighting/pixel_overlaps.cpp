// Overlaps are estimated on a lattice of points in every target pixel, and on one in the source pixels that it misses.
#include "lighting/pixel_overlaps.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

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

}  // namespace

PixelOverlaps::PixelOverlaps(const ProbeLayout& from, const ProbeLayout& to, int points_a_side)
    : from_(from), to_(to), from_solid_angles_(pixel_solid_angles(from)), to_solid_angles_(pixel_solid_angles(to)) {
    // At least so many points a side to a pixel of the finer image; 32 are enough to shrink a map by more than ten
    // a side, because what they miss of single pixels is put right by scattering and by the balance.
    const double ratio = std::sqrt(pixels_on_sphere(from) / pixels_on_sphere(to));
    points_ = std::clamp(static_cast<int>(std::ceil(points_a_side * ratio)), points_a_side + 1, 32);
    // Kept where it fits in some 300 MB, made anew for every pass where not.
    const std::int64_t entries =
        static_cast<std::int64_t>(to.width) * to.height * 12 + static_cast<std::int64_t>(from.width) * from.height * 4;
    kept_ = entries * static_cast<std::int64_t>(sizeof(PixelOverlap)) < (std::int64_t{300} << 20);
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

template <class Add>
std::vector<float> PixelOverlaps::sums_of_sources(const Add& add) const {
    const std::size_t source_pixels = from_solid_angles_.size();
    std::vector<std::vector<float>> parts(static_cast<std::size_t>(bands_), std::vector<float>(source_pixels, 0.0f));
    for_each_pixel([&](int band, std::uint32_t target, std::span<const PixelOverlap> overlaps) {
        add(target, overlaps, parts[static_cast<std::size_t>(band)]);
    });
    for (std::size_t part = 1; part < parts.size(); ++part) {
        for (std::size_t i = 0; i < source_pixels; ++i) parts[0][i] += parts[part][i];
    }
    return std::move(parts[0]);
}

std::vector<float> PixelOverlaps::handed_out(const std::vector<float>& source_gain) const {
    return sums_of_sources([&](std::uint32_t target, std::span<const PixelOverlap> overlaps, std::vector<float>& sums) {
        double received = 0;
        for (const PixelOverlap& overlap : overlaps) {
            received += static_cast<double>(overlap.solid_angle) * source_gain[overlap.source];
        }
        if (received <= 0) return;
        const auto target_gain = static_cast<float>(to_solid_angles_[target] / received);
        for (const PixelOverlap& overlap : overlaps) {
            sums[overlap.source] += overlap.solid_angle * source_gain[overlap.source] * target_gain;
        }
    });
}

std::vector<float> PixelOverlaps::change_handed_out(const std::vector<float>& source_gain,
                                                    const std::vector<float>& direction) const {
    return sums_of_sources([&](std::uint32_t target, std::span<const PixelOverlap> overlaps, std::vector<float>& sums) {
        double received = 0;
        double mean = 0;
        for (const PixelOverlap& overlap : overlaps) {
            const double share = static_cast<double>(overlap.solid_angle) * source_gain[overlap.source];
            received += share;
            mean += share * direction[overlap.source];
        }
        if (received <= 0) return;
        mean /= received;
        const double target_gain = to_solid_angles_[target] / received;
        for (const PixelOverlap& overlap : overlaps) {
            sums[overlap.source] += static_cast<float>(overlap.solid_angle * source_gain[overlap.source] * target_gain *
                                                       (direction[overlap.source] - mean));
        }
    });
}

Eigen::MatrixXd PixelOverlaps::change_between_groups(const std::vector<float>& source_gain,
                                                     const std::vector<std::uint16_t>& group_of, int groups) const {
    std::vector<Eigen::MatrixXd> parts(static_cast<std::size_t>(bands_), Eigen::MatrixXd::Zero(groups, groups));
    std::vector<std::vector<std::pair<std::uint16_t, double>>> shares(static_cast<std::size_t>(bands_));
    for_each_pixel([&](int band, std::uint32_t target, std::span<const PixelOverlap> overlaps) {
        auto& met = shares[static_cast<std::size_t>(band)];
        met.clear();
        double received = 0;
        for (const PixelOverlap& overlap : overlaps) {
            const double share = static_cast<double>(overlap.solid_angle) * source_gain[overlap.source];
            const std::uint16_t group = group_of[overlap.source];
            const auto known = std::find_if(met.begin(), met.end(), [&](const auto& m) { return m.first == group; });
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

/// On a disc, what lies in a pixel whose centre is outside counts for the nearest one inside: nobody reads the
/// pixel itself.
bool PixelOverlaps::is_read(int x, int y) const {
    return x >= 0 && y >= 0 && x < to_.width && y < to_.height && to_solid_angles_[index_in(to_, x, y)] > 0;
}

PixelOverlaps::Row PixelOverlaps::make_row(int y) const {
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

Eigen::Vector2d PixelOverlaps::lattice_point(int x, int y, int i, int j) const {
    return {x + (i + 0.5) / points_ - 0.5, y + (j + 0.5) / points_ - 0.5};
}

void PixelOverlaps::add_points(int x, int y, std::size_t first, std::vector<PixelOverlap>& entries) const {
    for (int j = 0; j < points_; ++j) {
        for (int i = 0; i < points_; ++i) add_point(lattice_point(x, y, i, j), first, entries);
    }
}

/// The points of neighbours that nobody reads, where this pixel is the nearest.
void PixelOverlaps::add_points_beyond(int x, int y, std::size_t first, std::vector<PixelOverlap>& entries) const {
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
void PixelOverlaps::add_point(const Eigen::Vector2d& point, std::size_t first,
                              std::vector<PixelOverlap>& entries) const {
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
void PixelOverlaps::scatter_missed() {
    const std::vector<float> gathered =
        sums_of_sources([](std::uint32_t, std::span<const PixelOverlap> overlaps, std::vector<float>& sums) {
            for (const PixelOverlap& overlap : overlaps) sums[overlap.source] += overlap.solid_angle;
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
            for (int j = 0; j < points; ++j) {
                for (int i = 0; i < points; ++i) {
                    const Eigen::Vector2d point(x + (i + 0.5) / points - 0.5, y + (j + 0.5) / points - 0.5);
                    if (solid_angle_density(from_, point) <= 0) continue;
                    const Eigen::Vector2i target = nearest_pixel(to_, *direction_from_pixel(from_, point));
                    targets.at(count++) = index_in(to_, target.x(), target.y());
                }
            }
            for (std::size_t i = 0; i < count; ++i) {
                missed_.push_back({targets.at(i), {source, static_cast<float>(missed / static_cast<double>(count))}});
            }
        }
    }
    std::stable_sort(missed_.begin(), missed_.end(),
                     [](const Missed& a, const Missed& b) { return a.target < b.target; });
    for (int y = 0; y <= to_.height; ++y) {
        const auto begins = std::lower_bound(
            missed_.begin(), missed_.end(), static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(to_.width),
            [](const Missed& missed, std::uint64_t target) { return missed.target < target; });
        first_missed_[static_cast<std::size_t>(y)] = static_cast<std::size_t>(begins - missed_.begin());
    }
}

void PixelOverlaps::add_missed(int y, Row& row) const {
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

}  // namespace matchlight
