// Bracketed photographs at their worst: dark, white, alone, in disorder, equal, noisy, and with a sun in them.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "calibration/hdr_merge.h"
#include "calibration/response_fit.h"
#include "core/error.h"
#include "core/warnings.h"
#include "media/image_io.h"
#include "report/stability_cases.h"
#include "report/synthetic_bracket.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

constexpr int green = 1;

MergedPhotograph merged_of(const ImageF& radiance, const std::vector<double>& exposures,
                           const SyntheticCamera& camera) {
    Warnings unheard;
    unheard.set_quiet(true);
    return merge_exposures(photographed(radiance, exposures, camera), camera.response, {}, unheard);
}

/// log2 of the mean over a region against the truth's.
double bias_ev(const MergedPhotograph& merged, const ImageF& radiance, const Region& region) {
    double found = 0, truth = 0;
    for (int y = region.y; y < region.y + region.height; ++y) {
        for (int x = region.x; x < region.x + region.width; ++x) {
            found += merged.radiance.at(x, y, green);
            truth += radiance.at(x, y, green);
        }
    }
    return std::log2(found / truth);
}

/// The worst of the parts of a ramp, from `first` on, where light stands out of the noise.
double worst_bias_ev(const MergedPhotograph& merged, const ImageF& radiance, int first) {
    constexpr int step = 32;
    double worst = 0;
    for (int x = first; x + step <= radiance.width(); x += step)
        worst = std::max(worst, std::abs(bias_ev(merged, radiance, {x, 0, step, radiance.height()})));
    return worst;
}

/// 1 where the job is refused as a bad input, 0 where it is done.
template <class Job>
StabilityOutcome refusal(const Job& job) {
    Warnings unheard;
    unheard.set_quiet(true);
    try {
        job(unheard);
    } catch (const InputError&) {
        return {1};
    }
    return {0};
}

constexpr Bound refused{1, 1};

/// Three photographs of a ramp as files, gone again with it.
class PhotographFiles {
public:
    PhotographFiles() : folder_(fs::temp_directory_path() / fmt::format("matchlight_stability_{}", ::getpid())) {
        fs::create_directories(folder_);
        const ExposureSeries series = photographed(radiance_ramp(128, 32, 8), times_s, {});
        for (std::size_t i = 0; i < series.shots.size(); ++i) {
            const ImageF& code = series.shots[i].code;
            Image8 picture(code.width(), code.height(), 3);
            std::transform(code.samples().begin(), code.samples().end(), picture.samples().begin(),
                           [](float value) { return static_cast<std::uint8_t>(std::lround(255 * value)); });
            paths.push_back(folder_ / fmt::format("{}.png", i));
            write_png8(paths.back(), picture);
        }
    }
    ~PhotographFiles() {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }
    PhotographFiles(const PhotographFiles&) = delete;
    PhotographFiles& operator=(const PhotographFiles&) = delete;

    std::vector<double> times_s = {16, 4, 1};  // the longest first, as the series has them
    std::vector<fs::path> paths;

private:
    fs::path folder_;
};

double difference_when_unordered() {
    const PhotographFiles files;
    Warnings unheard;
    unheard.set_quiet(true);
    const auto merged = [&](const std::vector<std::size_t>& order) {
        std::vector<fs::path> paths;
        ExposureOptions given;
        for (const std::size_t i : order) {
            paths.push_back(files.paths[i]);
            given.times_s.push_back(files.times_s[i]);
        }
        return merge_exposures(read_exposure_series(paths, given, unheard), Response::srgb(), {}, unheard);
    };
    const MergedPhotograph ordered = merged({0, 1, 2}), unordered = merged({1, 2, 0});
    double worst = 0;
    for (std::size_t i = 0; i < ordered.radiance.samples().size(); ++i) {
        worst = std::max(
            worst, static_cast<double>(std::abs(ordered.radiance.samples()[i] - unordered.radiance.samples()[i])));
    }
    return worst;
}

void add_extreme_cases(std::vector<StabilityCase>& cases) {
    cases.push_back(
        {"merge", "all photographs black", "largest light over the longest exposure's noise", {0, 6}, {}, [] {
             const SyntheticCamera camera;
             const MergedPhotograph merged = merged_of(ImageF(64, 64, 3, 0.0f), {1, 4, 16}, camera);
             const auto samples = merged.radiance.samples();
             return StabilityOutcome{*std::max_element(samples.begin(), samples.end()) * 16 / camera.read_noise};
         }});
    cases.push_back(
        {"merge", "all photographs white", "least light over the shortest exposure's full", {1 - 1e-6, 1}, {}, [] {
             const MergedPhotograph merged = merged_of(ImageF(64, 64, 3, 1e9f), {1, 4, 16}, {});
             const auto samples = merged.radiance.samples();
             return StabilityOutcome{*std::min_element(samples.begin(), samples.end())};
         }});
    cases.push_back({"merge", "one photograph alone", "worst bias, EV", {0, 0.02}, {}, [] {
                         const ImageF radiance = radiance_ramp(256, 64, 6);
                         return StabilityOutcome{worst_bias_ev(merged_of(radiance, {0.9}, {}), radiance, 96)};
                     }});
    cases.push_back({"merge", "photographs in disorder", "largest difference from them in order", {0, 0}, {}, [] {
                         return StabilityOutcome{difference_when_unordered()};
                     }});
    cases.push_back({"merge", "photographs of equal times", "refused", refused, {}, [] {
                         const PhotographFiles files;
                         return refusal([&](Warnings& warnings) {
                             read_exposure_series(files.paths, {{1, 1, 1}, {}, {}}, warnings);
                         });
                     }});
    cases.push_back(
        {"merge", "noise of a twentieth of full code", "worst bias, EV", {0, 0.15}, {}, [] {
             // Weights follow the estimate, so its relative variance, 0.3² here, is the order of its bias.
             const SyntheticCamera camera{.read_noise = 0.05, .shot_noise = 0.02};
             const ImageF radiance = radiance_ramp(512, 128, 10);
             // From where the longest exposure stands three deviations above black.
             return StabilityOutcome{worst_bias_ev(merged_of(radiance, {0.25, 1, 4, 16, 64}, camera), radiance, 256)};
         }});
}

/// Walls of 0.3 with a sun of 12 × 12 pixels.
struct Sun {
    static constexpr Region region{20, 20, 12, 12};
    ImageF radiance;

    explicit Sun(float light) : radiance(96, 96, 3, 0.3f) {
        for (int y = region.y; y < region.y + region.height; ++y) {
            for (int x = region.x; x < region.x + region.width; ++x) std::fill_n(radiance.pixel(x, y), 3, light);
        }
    }
};

void add_sun_in_brackets_cases(std::vector<StabilityCase>& cases) {
    constexpr float light = 3e5f;  // a million times the walls
    std::vector<double> exposures;
    for (int i = 0; i < 8; ++i) exposures.push_back(2 * std::pow(0.125, i));  // the sun is full down to the seventh
    cases.push_back(
        {"merge", "a sun a million times the walls", "worse bias of sun and walls, EV", {0, 0.02}, {}, [exposures] {
             const Sun sun(light);
             const MergedPhotograph merged = merged_of(sun.radiance, exposures, {});
             return StabilityOutcome{std::max(std::abs(bias_ev(merged, sun.radiance, Sun::region)),
                                              std::abs(bias_ev(merged, sun.radiance, {50, 50, 40, 40})))};
         }});
    cases.push_back({"merge",
                     "the same, full in every photograph",
                     "the sun over the shortest exposure's full",
                     {0.95, 1},
                     {},
                     [exposures] {
                         const Sun sun(light);
                         std::vector<double> longer = exposures;
                         longer.resize(5);
                         const MergedPhotograph merged = merged_of(sun.radiance, longer, {});
                         const bool flagged =
                             merged.clipped_pixels == static_cast<std::int64_t>(Sun::region.width) * Sun::region.height;
                         const double bound = 1 / *std::min_element(longer.begin(), longer.end());
                         return StabilityOutcome{flagged ? merged.radiance.at(25, 25, green) / bound : 0};
                     }});
}

void add_response_cases(std::vector<StabilityCase>& cases) {
    const auto add_refusal = [&](const std::string& name, float light, std::vector<double> exposures) {
        cases.push_back({"response", name, "refused", refused, {}, [light, exposures = std::move(exposures)] {
                             return refusal([&](Warnings& warnings) {
                                 fit_response(photographed(ImageF(64, 64, 3, light), exposures, {}),
                                              ResponseMethod::automatic, warnings);
                             });
                         }});
    };
    add_refusal("from photographs all black", 0, {1, 4, 16});
    add_refusal("from photographs all white", 1e9f, {1, 4, 16});
    add_refusal("from one photograph alone", 0.3f, {1});
    cases.push_back({"response", "sRGB from noisy photographs", "residual, EV", {0, 0.05}, {}, [] {
                         const SyntheticCamera camera{.read_noise = 0.01, .shot_noise = 0.005};
                         Warnings unheard;
                         unheard.set_quiet(true);
                         const ResponseFit fit =
                             fit_response(photographed(radiance_ramp(360, 240, 10), {1, 4, 16, 64}, camera),
                                          ResponseMethod::automatic, unheard);
                         return StabilityOutcome{fit.residual_ev};
                     }});
}

}  // namespace

std::vector<StabilityCase> exposure_cases() {
    std::vector<StabilityCase> cases;
    add_extreme_cases(cases);
    add_sun_in_brackets_cases(cases);
    add_response_cases(cases);
    return cases;
}

}  // namespace matchlight
