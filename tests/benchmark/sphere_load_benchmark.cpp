// How long sphere sets take to load, and the most memory that is held while they do, against what they take in the end.
#include <filesystem>
#include <fstream>
#include <string>

#include <benchmark/benchmark.h>
#include <unistd.h>

#include "scene/sphere_file.h"
#include "scene/sphere_generate.h"
#include "scene/sphere_write.h"

namespace matchlight {
namespace {

/// Resident memory as /proc has it: "VmRSS:" now, "VmHWM:" the most since it was set back.
double resident_bytes(const std::string& wanted) {
    std::ifstream status("/proc/self/status");
    std::string key;
    double kibibytes = 0;
    while (status >> key) {
        if (key == wanted && status >> kibibytes) return kibibytes * 1024;
        std::getline(status, key);
    }
    return 0;
}

void load(benchmark::State& state, const char* name, const char* extension, std::uint64_t count) {
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("matchlight_spheres_" + std::to_string(getpid()) + extension);
    SphereWriter writer(path, count, {});
    generate_spheres({.name = name, .seed = 1, .count = count}, [&](const Sphere& sphere) { writer.add(sphere); });
    writer.finish();
    for (auto step : state) {
        state.PauseTiming();
        std::ofstream("/proc/self/clear_refs") << 5;  // sets the peak back
        const double before = resident_bytes("VmRSS:");
        state.ResumeTiming();
        Warnings warnings;
        const SphereSet set = load_sphere_set(path, {}, warnings);
        state.PauseTiming();
        state.counters["bytes"] = static_cast<double>(set.bytes());
        state.counters["peak_over_bytes"] = (resident_bytes("VmHWM:") - before) / static_cast<double>(set.bytes());
        state.ResumeTiming();
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
    std::filesystem::remove(path);
}

BENCHMARK_CAPTURE(load, ply_C2, "C2", ".ply", 2'463'048)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(load, csv_C2, "C2", ".csv", 2'463'048)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(load, xyz_C2, "C2", ".xyz", 2'463'048)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(load, ply_C4, "C4", ".ply", 27'000'000)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK_CAPTURE(load, csv_C4, "C4", ".csv", 27'000'000)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace matchlight
