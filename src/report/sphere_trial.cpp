// Round robin over views, and pixel by pixel against rays.
#include "report/sphere_trial.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "core/stop.h"
#include "core/transfer.h"
#include "report/run_time.h"

namespace matchlight {
namespace {

double code_of(double light) {
    return 255 * std::clamp(srgb_code_from_linear(light), 0.0, 1.0);
}

/// What one row of a picture adds.
struct RowSums {
    SphereCheckRow counts;
    double coverage = 0;
};

void add(RowSums& sum, const RowSums& row) {
    sum.counts.pixels += row.counts.pixels;
    sum.counts.edge_pixels += row.counts.edge_pixels;
    sum.counts.largest_codes = std::max(sum.counts.largest_codes, row.counts.largest_codes);
    sum.counts.over_one_code += row.counts.over_one_code;
    sum.counts.largest_coverage = std::max(sum.counts.largest_coverage, row.counts.largest_coverage);
    sum.counts.over_a_sixteenth += row.counts.over_a_sixteenth;
    sum.coverage += row.coverage;
}

/// Largest difference of codes over the channels at a pixel's middle.
double codes_off(const SphereCaster& spheres, const SphereRay& ray, const SphereLight& light, const float* drawn) {
    Eigen::Vector3d expected = Eigen::Vector3d::Zero();
    if (const auto hit = spheres.nearest(ray)) expected = light(point_of(spheres, ray, *hit));
    double most = 0;
    for (int c = 0; c < 3; ++c) {
        most = std::max(most, std::abs(code_of(expected[c]) - code_of(static_cast<double>(drawn[c]))));
    }
    return most;
}

}  // namespace

std::vector<SphereStudyRow> time_over_views(const SpherePart& part, std::span<const ReferenceView> views, int repeats) {
    const std::size_t ways = part.ways.size();
    std::vector<std::vector<double>> times_ms(ways), ratios(ways);
    for (std::size_t frame = 0; frame < views.size(); ++frame) {
        std::vector<std::function<void()>> works;
        for (const SphereWay& way : part.ways) works.push_back([&way, &views, frame] { way.draw(views[frame]); });
        const std::vector<RunTime> times =
            time_in_turn(works, Stopwatch::wall, {.repeats = repeats, .most_seconds = 1e9, .warm_up = frame == 0});
        for (std::size_t way = 0; way < ways; ++way) {
            times_ms[way].push_back(times[way].median_ms);
            ratios[way].push_back(times[0].median_ms / std::max(times[way].median_ms, 1e-6));
        }
    }
    std::vector<SphereStudyRow> rows;
    for (std::size_t way = 0; way < ways; ++way) {
        SphereStudyRow& row = rows.emplace_back();
        row.part = part.name;
        row.way = part.ways[way].name;
        row.frames = views.size();
        if (views.empty()) continue;
        row.time = run_time_of(times_ms[way]);
        if (way > 0) row.speedup = run_time_of(ratios[way]).median_ms;
        if (part.ways[way].beside) {
            part.ways[way].draw(views.back());
            row.beside = part.ways[way].beside();
        }
    }
    return rows;
}

SphereCheckRow check_against_rays(const SphereCaster& spheres, std::span<const ReferenceView> views,
                                  const DrawnSpheres& drawn, const SphereLight& light,
                                  const SphereCheckOptions& options) {
    RowSums sum;
    for (const ReferenceView& view : views) {
        if (stop_requested()) throw InputError("", "stopped by a signal");
        const ImageF picture = drawn(view);
        const int rows = (view.height() + options.stride_px - 1) / options.stride_px;
        std::vector<RowSums> sums(static_cast<std::size_t>(rows));
        parallel_for(rows, [&](int row) {
            const int y = row * options.stride_px;
            RowSums& of_row = sums[static_cast<std::size_t>(row)];
            for (int x = 0; x < view.width(); x += options.stride_px) {
                ++of_row.counts.pixels;
                if (!is_sphere_edge(spheres, view, x, y, {.side = 4, .margin_px = options.margin_px})) {
                    const double codes = codes_off(spheres, view.ray_through(x, y), light, picture.pixel(x, y));
                    of_row.counts.largest_codes = std::max(of_row.counts.largest_codes, codes);
                    of_row.counts.over_one_code += codes > 1 ? 1 : 0;
                    continue;
                }
                double covered = 0;
                for (const SphereShare& share : reference_coverage(spheres, view, x, y, options.coverage_side)) {
                    if (share.id != no_sphere) covered += share.share;
                }
                const double off = std::abs(covered - static_cast<double>(picture.at(x, y, 3)));
                ++of_row.counts.edge_pixels;
                of_row.counts.largest_coverage = std::max(of_row.counts.largest_coverage, off);
                of_row.counts.over_a_sixteenth += off > 1.0 / 16 ? 1 : 0;
                of_row.coverage += off;
            }
        });
        for (const RowSums& of_row : sums) add(sum, of_row);
    }
    SphereCheckRow result = sum.counts;
    result.frames = views.size();
    if (result.edge_pixels > 0) result.mean_coverage = sum.coverage / static_cast<double>(result.edge_pixels);
    return result;
}

}  // namespace matchlight
