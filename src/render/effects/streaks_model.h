// What streaks are, whichever way they are computed: how long, how wide, how they fade.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "render/effects/bright_light.h"
#include "scene/effects.h"

namespace matchlight {

/// The picture that the settings count in has this many steps from top to bottom, as the study's squares of 128 texels:
/// so streaks are alike at every resolution.
inline constexpr int streak_steps_of_frame = 128;

/// One streak of unit sum: along it light falls off as attenuation^(distance / step), from the source to its end;
/// across it a Gaussian.
struct StreakShape {
    double step_px = 0;
    double length_px = 0;    // 4^passes steps
    double attenuation = 0;  // from step to step
    double sigma_px = 0;     // as a texel of the study's square once reduced and magnified; a pixel at least
};

inline StreakShape streak_shape(const GlareSettings& settings, int frame_height_px) {
    const double step = static_cast<double>(frame_height_px) / streak_steps_of_frame;
    return {.step_px = step,
            .length_px = step * std::exp2(2 * settings.passes),
            .attenuation = settings.attenuation,
            .sigma_px = std::max(step / 2, 1.0)};
}

/// Angles of the streaks, counter-clockwise from the picture's right, radians; each sends 1/n of the light.
inline std::vector<double> streak_angles(const GlareSettings& settings) {
    std::vector<double> angles;
    for (int d = 0; d < settings.directions; ++d) {
        const double turned = settings.angle_deg + 360.0 * d / settings.directions;
        angles.push_back(turned * std::numbers::pi / 180);
    }
    return angles;
}

/// The light that streaks. The classic model measures luminance and holds nothing back.
inline BrightPassSettings streak_light(const GlareSettings& settings, BrightShare share = BrightShare::all,
                                       double object_strength = 1) {
    const bool classic = settings.level == GlareLevel::classic;
    return {.threshold = settings.threshold,
            .knee = settings.knee,
            .firefly_safe = !classic,
            .share = share,
            .object_strength = object_strength,
            .measure = classic ? BrightMeasure::luminance : BrightMeasure::largest_channel};
}

/// Side of the square that the classic model squeezes the picture into.
inline constexpr int classic_streak_size = 128;

}  // namespace matchlight
