// Samples a probe where a tag's cells should be in it.
#include "tracking/probe_card.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/median.h"
#include "tracking/robust_plane.h"

namespace matchlight {

namespace {

struct CellInProbe {
    double a = 0, b = 0;  // from the tag's centre, in half sides of the grid
    bool paper = false;
    Eigen::Vector3d radiance = Eigen::Vector3d::Zero();
};

/// Cells far enough from grazing and large enough in the probe, each the mean over its inner part.
std::vector<CellInProbe> cells_in_probe(const Probe& probe, const Eigen::Vector3d& probe_place_m,
                                        const TagPattern& pattern, const TagPlace& place) {
    const double cell_m = place.size_m / (pattern.border_end - pattern.border_begin);
    const double half = 0.5 * pattern.cells;
    const double radians_per_pixel = 2 * std::numbers::pi / probe.latlong.width();
    const Eigen::Vector3d normal = place.world_from_tag.linear() * Eigen::Vector3d::UnitZ();
    std::vector<CellInProbe> cells;
    for (int y = 0; y < pattern.cells; ++y) {
        for (int x = 0; x < pattern.cells; ++x) {
            if (pattern.at(x, y) == TagPattern::unknown) continue;
            const auto from_probe = [&](double a, double b) {
                const Eigen::Vector3d on_tag((a - half) * cell_m, (half - b) * cell_m, 0);
                return Eigen::Vector3d(place.world_from_tag * on_tag - probe_place_m);
            };
            const Eigen::Vector3d middle = from_probe(x + 0.5, y + 0.5);
            const double distance_m = middle.norm();
            const double cosine = -middle.dot(normal) / distance_m;
            constexpr double least_cosine = 0.5;
            // Of a cell two pixels high, the inner part is one: a bilinear sample at its middle sees nothing else.
            constexpr double fewest_pixels = 3;
            if (!(cosine >= least_cosine)) continue;
            if (cell_m * cosine / distance_m < fewest_pixels * radians_per_pixel) continue;
            CellInProbe cell;
            cell.a = (x + 0.5 - half) / half;
            cell.b = (y + 0.5 - half) / half;
            cell.paper = pattern.at(x, y) == TagPattern::white;
            constexpr int samples = 4;  // a side, over the middle half of the cell
            for (int v = 0; v < samples; ++v) {
                for (int u = 0; u < samples; ++u) {
                    const auto inner = [](int i) { return 0.25 + 0.5 * (i + 0.5) / samples; };
                    cell.radiance += probe.radiance(from_probe(x + inner(u), y + inner(v)).normalized());
                }
            }
            cell.radiance /= samples * samples;
            cells.push_back(cell);
        }
    }
    return cells;
}

double mean_of(const Eigen::Vector3d& radiance) {
    return radiance.mean();
}

/// Whether bright and dark cells are where the pattern has paper and ink.
bool shows_pattern(const std::vector<CellInProbe>& cells) {
    std::vector<double> paper, ink;
    for (const CellInProbe& cell : cells) (cell.paper ? paper : ink).push_back(mean_of(cell.radiance));
    constexpr std::size_t fewest = 8;  // fewer could look like it by chance
    if (paper.size() < fewest || ink.size() < fewest) return false;
    const double bright = upper_median(paper), dark = upper_median(ink);
    // Print has a contrast of ten and more; half of it is lost where the place is off by a good part of a cell.
    constexpr double least_contrast = 3;
    if (!(bright > least_contrast * dark)) return false;
    const double between = std::sqrt(std::max(dark, 1e-3 * bright) * bright);
    const auto wrong = std::ranges::count_if(
        cells, [&](const CellInProbe& cell) { return (mean_of(cell.radiance) > between) != cell.paper; });
    constexpr double most_wrong = 0.05;  // a ball's stand over a corner
    return static_cast<double>(wrong) <= most_wrong * static_cast<double>(cells.size());
}

}  // namespace

std::optional<std::array<double, 3>> card_in_probe(const Probe& probe, const Eigen::Vector3d& probe_place_m,
                                                   const TagPattern& pattern, const TagPlace& place) {
    const std::vector<CellInProbe> cells = cells_in_probe(probe, probe_place_m, pattern, place);
    if (!shows_pattern(cells)) return std::nullopt;
    std::array<double, 3> difference{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        std::vector<PlaneSample> paper, ink;
        for (const CellInProbe& cell : cells) {
            const double value = cell.radiance[static_cast<Eigen::Index>(channel)];
            (cell.paper ? paper : ink).push_back({cell.a, cell.b, value, 1});
        }
        difference[channel] = fit_robust_plane(paper, 0).value - fit_robust_plane(ink, 0).value;
        if (!(difference[channel] > 0)) return std::nullopt;
    }
    return difference;
}

}  // namespace matchlight
