// Counts, then places, then halves.
#include "scene/sphere_cells.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace matchlight {

namespace {

using Index = std::uint32_t;

/// An even grid over the centres' box; its cells hold a half of what is wanted where the set is even.
class Grid {
public:
    Grid(const SphereSet& set, std::size_t most) {
        low_.fill(std::numeric_limits<float>::max());
        std::array<float, 3> high{};
        high.fill(std::numeric_limits<float>::lowest());
        for (const Sphere& sphere : set.spheres) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low_[axis] = std::min(low_[axis], sphere.centre_m[axis]);
                high[axis] = std::max(high[axis], sphere.centre_m[axis]);
            }
        }
        const double wanted = std::clamp(2.0 * static_cast<double>(set.size()) / static_cast<double>(most), 1.0, 4e6);
        double longest = 0, volume = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) longest = std::max(longest, double(high[axis]) - low_[axis]);
        if (longest == 0) return;
        // A flat box counts as a thin one.
        const double thin = longest / 1024;
        for (std::size_t axis = 0; axis < 3; ++axis) volume *= std::max(double(high[axis]) - low_[axis], thin);
        const double side = std::cbrt(volume / wanted);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double length = double(high[axis]) - low_[axis];
            counts_[axis] = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(length / side)));
            if (length > 0) per_m_[axis] = static_cast<double>(counts_[axis]) / length;
        }
    }
    std::size_t size() const { return counts_[0] * counts_[1] * counts_[2]; }
    std::size_t cell_of(const Sphere& sphere) const {
        std::array<std::size_t, 3> at{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double along = (double(sphere.centre_m[axis]) - low_[axis]) * per_m_[axis];
            at[axis] = std::min(static_cast<std::size_t>(along), counts_[axis] - 1);
        }
        return at[0] + counts_[0] * (at[1] + counts_[1] * at[2]);
    }

private:
    std::array<float, 3> low_{};
    std::array<double, 3> per_m_{};
    std::array<std::size_t, 3> counts_{1, 1, 1};
};

/// Of a place, to the last bit: neighbours have nothing in common.
std::uint64_t scrambled(const std::array<float, 3>& place) {
    std::uint64_t hash = 0;
    for (const float along : place) {
        // Steele, Lea & Flood 2014, "Fast Splittable Pseudorandom Number Generators": its finalizer.
        hash += std::bit_cast<std::uint32_t>(along) + 0x9e3779b97f4a7c15;
        hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9;
        hash = (hash ^ (hash >> 27)) * 0x94d049bb133111eb;
        hash ^= hash >> 31;
    }
    return hash;
}

void mix(const SphereSet& set, std::span<Index> members) {
    std::vector<std::pair<std::uint64_t, Index>> keys;
    keys.reserve(members.size());
    for (const Index i : members) keys.emplace_back(scrambled(set.spheres[i].centre_m), i);
    std::ranges::sort(keys);
    std::ranges::transform(keys, members.begin(), [](const auto& key) { return key.second; });
}

SphereCell cell_around(const SphereSet& set, std::span<const Index> members, std::size_t first) {
    SphereCell cell{.first = static_cast<Index>(first), .count = static_cast<Index>(members.size())};
    cell.low_m.fill(std::numeric_limits<float>::max());
    cell.high_m.fill(std::numeric_limits<float>::lowest());
    for (const Index i : members) {
        const Sphere& sphere = set.spheres[i];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            // Rounded outward: a long lens sees what floats round by.
            constexpr float far = std::numeric_limits<float>::infinity();
            cell.low_m[axis] =
                std::min(cell.low_m[axis], std::nextafter(sphere.centre_m[axis] - sphere.radius_m, -far));
            cell.high_m[axis] =
                std::max(cell.high_m[axis], std::nextafter(sphere.centre_m[axis] + sphere.radius_m, far));
        }
        cell.largest_radius_m = std::max(cell.largest_radius_m, sphere.radius_m);
    }
    return cell;
}

/// Appends the cells of `order`'s part of `count` from `first`.
void halve(const SphereSet& set, SphereCells& cells, std::size_t first, std::size_t count, std::size_t most) {
    const std::span<Index> members(cells.order.data() + first, count);
    if (count > most) {
        std::array<float, 3> low{}, high{};
        low.fill(std::numeric_limits<float>::max());
        high.fill(std::numeric_limits<float>::lowest());
        for (const Index i : members) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], set.spheres[i].centre_m[axis]);
                high[axis] = std::max(high[axis], set.spheres[i].centre_m[axis]);
            }
        }
        std::size_t longest = 0;
        for (std::size_t axis = 1; axis < 3; ++axis) {
            if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
        }
        if (high[longest] > low[longest]) {
            const std::size_t half = count / 2;
            // One order whatever the library's algorithm: of equal places the earlier sphere comes first.
            const auto before = [&](Index a, Index b) {
                const float at_a = set.spheres[a].centre_m[longest], at_b = set.spheres[b].centre_m[longest];
                return at_a < at_b || (at_a == at_b && a < b);
            };
            std::nth_element(members.begin(), members.begin() + static_cast<std::ptrdiff_t>(half), members.end(),
                             before);
            halve(set, cells, first, half, most);
            halve(set, cells, first + half, count - half, most);
            return;
        }
    }
    mix(set, members);
    cells.cells.push_back(cell_around(set, members, first));
}

}  // namespace

SphereCells sphere_cells(const SphereSet& set, std::size_t most) {
    assert(most > 0 && set.size() < std::numeric_limits<Index>::max());
    SphereCells cells;
    if (set.spheres.empty()) return cells;
    const Grid grid(set, most);
    std::vector<Index> starts(grid.size() + 1, 0);
    for (const Sphere& sphere : set.spheres) ++starts[grid.cell_of(sphere) + 1];
    for (std::size_t i = 1; i < starts.size(); ++i) starts[i] += starts[i - 1];
    cells.order.resize(set.size());
    std::vector<Index> next(starts.begin(), starts.end() - 1);
    for (std::size_t i = 0; i < set.size(); ++i) {
        cells.order[next[grid.cell_of(set.spheres[i])]++] = static_cast<Index>(i);
    }
    for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
        if (starts[i + 1] > starts[i]) halve(set, cells, starts[i], starts[i + 1] - starts[i], most);
    }
    return cells;
}

}  // namespace matchlight
