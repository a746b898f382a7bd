// What the measures of `matchlight compare` cost a frame, by size.
#include <cmath>
#include <cstdint>
#include <random>

#include <benchmark/benchmark.h>

#include "core/image.h"
#include "report/flip.h"
#include "report/image_error.h"
#include "report/ssim.h"

namespace matchlight {
namespace {

/// A smooth picture with grain: neither flat nor pure noise.
Image8 picture(int width, int height, unsigned seed) {
    Image8 image(width, height, 3);
    std::mt19937 random(seed);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < 3; ++c) {
                const double smooth = 128 + 90 * std::sin(0.01 * (x + 2 * y) + c);
                image.at(x, y, c) = static_cast<std::uint8_t>(smooth + static_cast<double>(random() % 16));
            }
        }
    }
    return image;
}

template <class Measure>
void run(benchmark::State& state, Measure measure) {
    const int width = static_cast<int>(state.range(0)), height = static_cast<int>(state.range(1));
    const Image8 reference = picture(width, height, 1), test = picture(width, height, 2);
    for (auto _ : state) benchmark::DoNotOptimize(measure(reference, test));
    state.SetItemsProcessed(state.iterations() * width * height);
}

void flip(benchmark::State& state) {
    run(state, [](const Image8& a, const Image8& b) { return flip_error_map(a, b); });
}
void structural_similarity(benchmark::State& state) {
    run(state, [](const Image8& a, const Image8& b) { return ssim(a, b); });
}
void peak_signal_to_noise(benchmark::State& state) {
    run(state, [](const Image8& a, const Image8& b) { return psnr_db(a, b); });
}

void sizes(benchmark::internal::Benchmark* benchmark) {
    benchmark->Args({640, 360})->Args({1920, 1080})->Unit(benchmark::kMillisecond)->UseRealTime();
}
BENCHMARK(flip)->Apply(sizes);
BENCHMARK(structural_similarity)->Apply(sizes);
BENCHMARK(peak_signal_to_noise)->Apply(sizes);

}  // namespace
}  // namespace matchlight
