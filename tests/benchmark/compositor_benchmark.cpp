// What a frame of the sample shot costs, by its size and quality level: decode and encode left out.
#include <memory>

#include <Eigen/Geometry>
#include <benchmark/benchmark.h>

#include "calibration/camera.h"
#include "compositor/compositor.h"
#include "gl/context.h"
#include "gpu/grey_plate.h"
#include "scene/scene_file.h"

namespace matchlight {
namespace {

/// 0: no effects of bright light; 1: asked for, but nothing is bright enough; 2: reflections on the objects are. 3:
/// depth of field alone, gathered.
EffectSettings effects_of(int use) {
    EffectSettings effects;
    if (use == 0) return effects;
    if (use == 3) {
        DepthOfFieldSettings& lens = effects.depth_of_field.emplace();
        lens.focus_distance_m = 0.62;  // the middle one of the objects
        lens.coc_scale_px_m = 60;      // circles of some 20 px
        return effects;
    }
    effects.bloom.emplace().threshold = use == 1 ? 1e5 : 0.25;
    effects.glare.emplace().threshold = use == 1 ? 1e5 : 0.5;
    return effects;
}

void composite(benchmark::State& state) {
    const int width = static_cast<int>(state.range(0)), height = static_cast<int>(state.range(1));
    Warnings warnings;
    warnings.set_quiet(true);
    const std::filesystem::path folder = std::filesystem::path(MATCHLIGHT_SOURCE_DIR) / "samples/table";
    Scene scene = load_scene(folder / "table.toml", warnings);
    scene.effects = effects_of(static_cast<int>(state.range(3)));
    Solve solve;
    solve.camera = camera_for_size(load_camera(folder / "camera.yaml"), width, height, folder / "camera.yaml");
    SolvedFrame frame;
    frame.camera_from_world = test::camera_before_the_table();
    frame.exposure_ev = -1;
    solve.frames.push_back(frame);
    const auto context = create_offscreen_context();
    Compositor compositor(*context, scene, solve, {.quality = static_cast<QualityLevel>(state.range(2))}, warnings);
    const PlateFrame plate = test::grey_plate(width, height);
    benchmark::DoNotOptimize(compositor.composite(plate));  // programs compile with the first frame
    for (auto _ : state) benchmark::DoNotOptimize(compositor.composite(plate).composited_plate());
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(composite)
    ->ArgNames({"width", "height", "level", "effects"})
    ->ArgsProduct({{1920}, {1080}, {0, 1, 2}, {0}})
    ->ArgsProduct({{640}, {360}, {2}, {0, 1, 2}})
    ->ArgsProduct({{1920}, {1080}, {2}, {1, 2}})
    ->ArgsProduct({{1920}, {1080}, {0, 1, 2}, {3}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace matchlight
