// The synthetic camera.
#include "report/synthetic_bracket.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <fmt/format.h>

namespace matchlight {
namespace {

ImageF codes_of(const ImageF& radiance, double exposure, const SyntheticCamera& camera, unsigned number) {
    std::seed_seq seeds{camera.seed, number};
    std::mt19937_64 random(seeds);
    std::normal_distribution<double> normal;
    ImageF code(radiance.width(), radiance.height(), 3);
    for (int y = 0; y < code.height(); ++y) {
        for (int x = 0; x < code.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                const double light = radiance.at(x, y, c) * exposure;
                const double sigma = std::sqrt(camera.read_noise * camera.read_noise + camera.shot_noise * light);
                // Not more than the well holds, and no negative charge.
                const double seen = std::max(light + sigma * normal(random), 0.0);
                const double exact = std::clamp(camera.response.code_from_linear(seen, c), 0.0, camera.full_code);
                code.at(x, y, c) = static_cast<float>(std::round(exact * camera.code_steps) / camera.code_steps);
            }
        }
    }
    return code;
}

}  // namespace

ExposureSeries photographed(const ImageF& radiance, const std::vector<double>& exposures,
                            const SyntheticCamera& camera) {
    ExposureSeries series;
    for (std::size_t i = 0; i < exposures.size(); ++i) {
        Photograph shot;
        shot.path = fmt::format("synthetic_{}.png", i);
        shot.record.exposure_s = exposures[i];
        shot.exposure = exposures[i];
        shot.code_step = 1.0 / camera.code_steps;
        shot.code = codes_of(radiance, exposures[i], camera, static_cast<unsigned>(i));
        series.shots.push_back(std::move(shot));
    }
    std::stable_sort(series.shots.begin(), series.shots.end(),
                     [](const Photograph& a, const Photograph& b) { return a.exposure > b.exposure; });
    return series;
}

ImageF radiance_ramp(int width, int height, double range_ev) {
    constexpr std::array<double, 3> tint = {1, 0.8, 0.5};
    ImageF radiance(width, height, 3);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double ev = -range_ev * (1 - (x + 0.5) / width);
            for (int c = 0; c < 3; ++c)
                radiance.at(x, y, c) = static_cast<float>(std::exp2(ev) * tint[static_cast<std::size_t>(c)]);
        }
    }
    return radiance;
}

}  // namespace matchlight
