// Merging bracketed photographs: time against error, ours, a plain hat-weighted mean and OpenCV's two.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <opencv2/photo.hpp>

#include "calibration/hdr_merge.h"
#include "calibration/response.h"
#include "core/warnings.h"
#include "report/synthetic_bracket.h"

namespace matchlight {
namespace {

constexpr int width = 1024, height = 768;
const std::vector<double> exposures = {256, 64, 16, 4, 1};

/// Fourteen stops in 1024 × 768 pixels, with a lamp that is full in every photograph.
struct Scene {
    ImageF radiance = radiance_ramp(width, height, 14);
    SyntheticCamera camera;
    ExposureSeries series;

    Scene() {
        for (int y = 100; y < 130; ++y) {
            for (int x = 100; x < 130; ++x) std::fill_n(radiance.pixel(x, y), 3, 1000.0f);
        }
        series = photographed(radiance, exposures, camera);
    }
};
const Scene& scene() {
    static const Scene one;
    return one;
}

/// Against the known light, a scale left free; the lamp, of which only a bound is known, by its share of black pixels.
void count_error(benchmark::State& state, const std::vector<float>& found) {
    const auto truth = scene().radiance.samples();
    std::vector<double> off, deviations;
    double black = 0, lamp = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (truth[i] >= 1000) {
            lamp += 1;
            black += found[i] > 0 ? 0 : 1;
        } else if (found[i] > 0) {
            off.push_back(std::log2(found[i] / truth[i]));
        }
    }
    std::sort(off.begin(), off.end());
    const double middle = off[off.size() / 2];
    for (const double value : off) deviations.push_back(std::abs(value - middle));
    std::sort(deviations.begin(), deviations.end());
    state.counters["photographs/s"] =
        benchmark::Counter(static_cast<double>(exposures.size() * state.iterations()), benchmark::Counter::kIsRate);
    state.counters["median_EV"] = deviations[deviations.size() / 2];
    state.counters["p99_EV"] = deviations[deviations.size() * 99 / 100];
    state.counters["black_suns"] = black / lamp;
}

void merge_ours(benchmark::State& state, Alignment align, bool deghost) {
    Warnings unheard;
    unheard.set_quiet(true);
    MergedPhotograph merged;
    for ([[maybe_unused]] auto run : state)
        merged = merge_exposures(scene().series, Response::srgb(), {.align = align, .deghost = deghost}, unheard);
    const auto samples = merged.radiance.samples();
    count_error(state, {samples.begin(), samples.end()});
}

/// A hat over the codes, one thread.
void merge_hat(benchmark::State& state) {
    const ExposureSeries& series = scene().series;
    std::array<double, 256> light{}, weight{};
    for (std::size_t code = 0; code < 256; ++code) {
        light[code] = Response::srgb().linear_from_code(static_cast<double>(code) / 255, 0);
        weight[code] = static_cast<double>(std::min(code, 255 - code));
    }
    std::vector<float> merged(scene().radiance.samples().size());
    for ([[maybe_unused]] auto run : state) {
        for (std::size_t i = 0; i < merged.size(); ++i) {
            double sum = 0, weights = 0;
            for (const Photograph& shot : series.shots) {
                const auto code = static_cast<std::size_t>(std::lround(255 * shot.code.samples()[i]));
                sum += weight[code] * light[code] / shot.exposure;
                weights += weight[code];
            }
            merged[i] = weights > 0 ? static_cast<float>(sum / weights) : 0;
        }
        benchmark::DoNotOptimize(merged.data());
    }
    count_error(state, merged);
}

template <class Merge>
void merge_opencv(benchmark::State& state, const cv::Ptr<Merge>& merge) {
    std::vector<cv::Mat> photographs;
    std::vector<float> times;
    for (const Photograph& shot : scene().series.shots) {
        cv::Mat picture(height, width, CV_8UC3);
        const auto codes = shot.code.samples();
        std::transform(codes.begin(), codes.end(), picture.data,
                       [](float code) { return static_cast<unsigned char>(std::lround(255 * code)); });
        photographs.push_back(picture);
        times.push_back(static_cast<float>(shot.exposure));
    }
    cv::Mat response(256, 1, CV_32FC3), merged;
    for (int code = 0; code < 256; ++code) {
        // A light of 0 has no logarithm.
        const auto light = static_cast<float>(Response::srgb().linear_from_code(std::max(code, 1) / 255.0, 0));
        response.at<cv::Vec3f>(code) = {light, light, light};
    }
    for ([[maybe_unused]] auto run : state) merge->process(photographs, merged, times, response);
    count_error(state, {merged.ptr<float>(), merged.ptr<float>() + merged.total() * 3});
}

BENCHMARK_CAPTURE(merge_ours, tripod, Alignment::off, false)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(merge_ours, ghosts, Alignment::off, true)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(merge_ours, ghosts_and_alignment, Alignment::automatic, true)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(merge_hat)->Unit(benchmark::kMillisecond)->UseRealTime();
void merge_debevec(benchmark::State& state) {
    merge_opencv(state, cv::createMergeDebevec());
}
void merge_robertson(benchmark::State& state) {
    merge_opencv(state, cv::createMergeRobertson());
}
BENCHMARK(merge_debevec)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(merge_robertson)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace matchlight
