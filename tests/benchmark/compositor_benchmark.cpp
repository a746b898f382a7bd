// What a frame of the sample shot costs, by its size and quality level: decode and encode left out.
#include <memory>

#include <Eigen/Geometry>
#include <benchmark/benchmark.h>

#include "calibration/camera.h"
#include "compositor/compositor.h"
#include "gl/context.h"
#include "media/plate_format.h"
#include "scene/scene_file.h"

extern "C" {
#include <libavutil/frame.h>
}

namespace matchlight {
namespace {

/// A grey 4:2:0 plate: what it shows does not matter to the cost.
PlateFrame grey_plate(int width, int height, const std::filesystem::path& path) {
    AVFrame* raw = av_frame_alloc();
    raw->width = width;
    raw->height = height;
    raw->format = AV_PIX_FMT_YUV420P;
    av_frame_get_buffer(raw, 0);
    std::fill_n(raw->data[0], static_cast<std::size_t>(raw->linesize[0]) * height, std::uint8_t{120});
    for (int plane = 1; plane < 3; ++plane) {
        std::fill_n(raw->data[plane], static_cast<std::size_t>(raw->linesize[plane]) * height / 2, std::uint8_t{128});
    }
    const std::shared_ptr<AVFrame> samples(raw, [](AVFrame* frame) { av_frame_free(&frame); });
    return {samples, plate_format_of(*samples, 0, {}, path), 0, 0.0};
}

/// Half a metre before the objects and as much above them, looking at them: about where the sample's camera stood.
RigidTransform camera_before_the_table() {
    const Eigen::Vector3d eye(0, -0.45, 0.42), target(0, 0.02, 0.03);
    const Eigen::Vector3d forward = (target - eye).normalized();
    const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
    RigidTransform world_from_camera = RigidTransform::Identity();
    world_from_camera.linear() << right, forward.cross(right), forward;
    world_from_camera.translation() = eye;
    return world_from_camera.inverse();
}

void composite(benchmark::State& state) {
    const int width = static_cast<int>(state.range(0)), height = static_cast<int>(state.range(1));
    Warnings warnings;
    warnings.set_quiet(true);
    const std::filesystem::path folder = std::filesystem::path(MATCHLIGHT_SOURCE_DIR) / "samples/table";
    const Scene scene = load_scene(folder / "table.toml", warnings);
    Solve solve;
    solve.camera = camera_for_size(load_camera(folder / "camera.yaml"), width, height, folder / "camera.yaml");
    SolvedFrame frame;
    frame.camera_from_world = camera_before_the_table();
    frame.exposure_ev = -1;
    solve.frames.push_back(frame);
    const auto context = create_offscreen_context();
    Compositor compositor(*context, scene, solve, {.quality = static_cast<QualityLevel>(state.range(2))}, warnings);
    const PlateFrame plate = grey_plate(width, height, folder / "plate.mp4");
    benchmark::DoNotOptimize(compositor.composite(plate));  // programs compile with the first frame
    for (auto _ : state) benchmark::DoNotOptimize(compositor.composite(plate).composited_plate());
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(composite)
    ->ArgNames({"width", "height", "level"})
    ->ArgsProduct({{1920}, {1080}, {0, 1, 2}})
    ->Args({640, 360, 2})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace matchlight
