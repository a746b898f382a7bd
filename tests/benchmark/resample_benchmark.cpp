// Resampling of a probe from lat-long to another mapping and back: what is lost against what it costs, by points of the
// lattice and passes of the balance. The reference is the probe itself, summed in double precision.
#include <benchmark/benchmark.h>

#include "lighting/latlong_grid.h"
#include "lighting/probe_comparison.h"
#include "lighting/resample.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;

constexpr int height = 128;

/// Walls with a gradient, and three lamps of one pixel, each in a channel of its own: at a pole, on the seam,
/// elsewhere.
Probe stiff_room() {
    Probe probe{ImageF(2 * height, height, 3)};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < 2 * height; ++x) {
            const Vector3d d = latlong_direction(x, y, 2 * height, height);
            for (int c = 0; c < 3; ++c) probe.latlong.at(x, y, c) = static_cast<float>(1 + 0.5 * d[c]);
        }
    }
    probe.latlong.at(40, 0, 0) = probe.latlong.at(0, 70, 1) = probe.latlong.at(150, 30, 2) = 1e6F;
    return probe;
}

Vector3d power_of(const Probe& probe) {
    const LatlongGrid grid(probe.latlong.width(), probe.latlong.height());
    Vector3d power = Vector3d::Zero();
    for (int y = 0; y < grid.height(); ++y) {
        for (int x = 0; x < grid.width(); ++x) {
            const float* p = probe.latlong.pixel(x, y);
            power += grid.solid_angle(y) * Vector3d(p[0], p[1], p[2]);
        }
    }
    return power;
}

/// The largest difference over directions and channels, over the largest irradiance of the channel.
double irradiance_error(const Probe& before, const Probe& after) {
    Vector3d worst = Vector3d::Zero(), largest = Vector3d::Zero();
    for (const Vector3d& normal : even_directions(100)) {
        const Vector3d expected = irradiance(before, normal);
        worst = worst.cwiseMax((irradiance(after, normal) - expected).cwiseAbs());
        largest = largest.cwiseMax(expected);
    }
    return worst.cwiseQuotient(largest).maxCoeff();
}

void there_and_back(benchmark::State& state, ProbeMapping mapping) {
    const ResampleOptions options{.points_a_side = static_cast<int>(state.range(0)),
                                  .most_passes = static_cast<int>(state.range(1)),
                                  .energy_tolerance = 1e-5};
    const Probe probe = stiff_room();
    const ProbeLayout latlong = layout_of_size(ProbeMapping::latlong, height);
    const ProbeLayout layout = layout_of_size(mapping, size_for_latlong(mapping, height));
    Probe back;
    for (auto _ : state) {
        back.latlong = resample(resample(probe.latlong, latlong, layout, options), layout, latlong, options);
        benchmark::DoNotOptimize(back.latlong.samples().data());
    }
    state.counters["energy"] = (power_of(back).cwiseQuotient(power_of(probe)) - Vector3d::Ones()).cwiseAbs().maxCoeff();
    state.counters["irradiance"] = irradiance_error(probe, back);
}

void qualities(benchmark::internal::Benchmark* benchmark) {
    for (const int points : {2, 3, 6}) {
        for (const int passes : {1, 4, 16, 48}) benchmark->Args({points, passes});
    }
    benchmark->ArgNames({"points", "passes"})->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(2);
}
BENCHMARK_CAPTURE(there_and_back, cube, ProbeMapping::cube)->Apply(qualities);
BENCHMARK_CAPTURE(there_and_back, angular, ProbeMapping::angular)->Apply(qualities);
BENCHMARK_CAPTURE(there_and_back, mirrorball, ProbeMapping::mirrorball)->Apply(qualities);

}  // namespace
}  // namespace matchlight
