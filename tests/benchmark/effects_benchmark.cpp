// What effects of bright light cost at 1080p, beside a plain copy of a full RGBA16F frame: each run of an effect is
// paired with a copy before it, so that the ratio `copies` holds on a busy machine.
#include <algorithm>
#include <chrono>
#include <cmath>

#include <benchmark/benchmark.h>

#include "gl/context.h"
#include "render/effects/bloom.h"
#include "render/effects/streaks.h"

namespace matchlight {
namespace {

constexpr int width = 1920, height = 1080;

const TextureShape frame_shape{.format = GL_RGBA16F, .width = width, .height = height};

/// A context, and a frame of which `after` holds some lamps and reflections that `before` does not.
struct Bench {
    std::unique_ptr<GlContext> context = create_offscreen_context();
    ShaderLibrary shaders;
    ShaderLibrary plain{MATCHLIGHT_SOURCE_DIR};
    RenderGraph graph;
    Texture2D after{frame_shape}, before{frame_shape}, copied{frame_shape};
    Framebuffer copy_target{copied};
    FullScreenTriangle triangle;

    Bench() {
        ImageF light(width, height, 4, 0.3F);
        before.upload(light);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const bool is_lamp = std::hypot(x - 700, y - 400) < 60 || std::hypot(x - 1400, y - 700) < 8;
                for (int c = 0; c < 3; ++c) light.at(x, y, c) = is_lamp ? 20.F : 0.3F;
                light.at(x, y, 3) = 1;
            }
        }
        after.upload(light);
        after.set_filter(Filter::nearest);
    }

    static Bench& get() {
        static Bench bench;
        return bench;
    }

    void copy() {
        Program& program = plain.program(
            {{GL_VERTEX_SHADER, "shaders/common/fullscreen.vert"}, {GL_FRAGMENT_SHADER, "tests/benchmark/copy.frag"}});
        copy_target.bind();
        program.use();
        program.bind_texture("source", 0, after);
        triangle.draw();
        glFinish();
    }

    template <class Add>
    void run(const Add& add) {
        graph.begin_frame(width, height);
        const Region all{0, 0, width, height};
        const FrameLight light{graph.import(&after, {GL_RGBA16F, all, 1}), graph.import(&before, {GL_RGBA16F, all, 1})};
        for (const GraphTexture texture : add(graph, light)) graph.output(texture);
        graph.run();
        glFinish();
    }
};

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
}

template <class Work>
double seconds_of(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

template <class Add>
void measure(benchmark::State& state, const Add& add) {
    Bench& bench = Bench::get();
    bench.context->make_current();
    bench.run(add);  // programs compile, textures are made
    bench.copy();
    std::vector<double> copies, effects;
    for (auto _ : state) {
        copies.push_back(seconds_of([&] { bench.copy(); }));
        effects.push_back(seconds_of([&] { bench.run(add); }));
        state.SetIterationTime(effects.back());
    }
    state.counters["copy_ms"] = 1e3 * median(copies);
    state.counters["effect_ms"] = 1e3 * median(effects);
    state.counters["copies"] = median(effects) / median(copies);
}

void bloom(benchmark::State& state, BloomLevel level, QualityLevel quality) {
    Bench& bench = Bench::get();
    GpuCondition bright("no light above the threshold");
    const BloomSettings settings{.level = level};
    measure(state, [&](RenderGraph& graph, const FrameLight& light) {
        return std::vector{add_bloom(graph, bench.shaders, light, settings, bloom_knobs(settings, quality), 1, bright)};
    });
}
BENCHMARK_CAPTURE(bloom, classic, BloomLevel::classic, QualityLevel::final_)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(15);
BENCHMARK_CAPTURE(bloom, draft, BloomLevel::pyramid, QualityLevel::draft)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(15);
BENCHMARK_CAPTURE(bloom, preview, BloomLevel::pyramid, QualityLevel::preview)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(15);
BENCHMARK_CAPTURE(bloom, final, BloomLevel::pyramid, QualityLevel::final_)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(15);
BENCHMARK_CAPTURE(bloom, reference, BloomLevel::reference, QualityLevel::final_)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(15);

void streaks(benchmark::State& state, GlareLevel level) {
    Bench& bench = Bench::get();
    GpuCondition bright("no light above the threshold");
    GlareSettings settings;
    settings.level = level;
    settings.directions = static_cast<int>(state.range(0));
    measure(state, [&](RenderGraph& graph, const FrameLight& light) {
        return std::vector{add_streaks(graph, bench.shaders, light, settings, {}, {}, bright)};
    });
}
BENCHMARK_CAPTURE(streaks, classic, GlareLevel::classic)
    ->Arg(4)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(15);
BENCHMARK_CAPTURE(streaks, final, GlareLevel::streaks)
    ->Arg(2)
    ->Arg(4)
    ->Arg(6)
    ->Arg(8)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(15);

}  // namespace
}  // namespace matchlight
