// Settings before what the solve found.
#include "compositor/sensor.h"

#include <fmt/format.h>

#include "render/effects/grain_noise.h"

namespace matchlight {

std::optional<GrainModel> grain_of_frame(const GrainSettings& settings, const Solve& solve, std::int64_t frame,
                                         double plate_gain, Warnings& warnings) {
    if (!solve.noise && !settings.read && !settings.shot) {
        warnings.add(fmt::format("{}: the noise is not known: grain is left out unless the scene gives read and shot",
                                 solve.footage_file));
        return std::nullopt;
    }
    const std::array<double, 2> solved = solve.noise.value_or(std::array<double, 2>{});
    GrainModel model;
    // Light · g has g² the variance: (g · read)² + (g · shot) · (g · signal).
    model.read = plate_gain * settings.read.value_or(solved[0]);
    model.shot = plate_gain * settings.shot.value_or(solved[1]);
    model.correlation_px =
        settings.correlation_px.value_or(grain_correlation_px(solve.noise_neighbour_correlation.value_or(0)));
    model.strength = settings.strength;
    model.seed = static_cast<std::uint32_t>(settings.seed);
    model.frame = static_cast<std::uint32_t>(frame);
    return model;
}

std::optional<LateralColor> lateral_color_of(const ChromaticAberrationSettings& settings, const Solve& solve,
                                             Warnings& warnings) {
    if (!settings.red_px && !settings.blue_px) {
        warnings.add(
            fmt::format("{}: the lens' chromatic aberration is not known: it is left out unless the scene "
                        "gives red_px and blue_px",
                        solve.footage_file));
        return std::nullopt;
    }
    return LateralColor{.red_px = settings.red_px.value_or(0),
                        .blue_px = settings.blue_px.value_or(0),
                        .frame_width = solve.camera.width,
                        .frame_height = solve.camera.height};
}

double softness_px_of(const SoftnessSettings& settings, const Solve& solve, Warnings& warnings) {
    if (settings.sigma_px) return *settings.sigma_px;
    if (!solve.softness_px) {
        warnings.add(
            fmt::format("{}: the footage's softness is not known: it is left out unless the scene gives "
                        "sigma_px",
                        solve.footage_file));
    }
    return solve.softness_px.value_or(0);
}

std::array<double, 2> vignette_of(const std::optional<VignetteSettings>& settings, const Solve& solve) {
    if (!settings) return {};
    const std::array<double, 2> solved = solve.vignette.value_or(std::array<double, 2>{});
    // One coefficient given alone is a whole curve: the solve's other one belongs to another.
    if (settings->v1 || settings->v2) return {settings->v1.value_or(0), settings->v2.value_or(0)};
    return solved;
}

}  // namespace matchlight
