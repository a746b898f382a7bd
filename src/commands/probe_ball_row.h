// A row of balls lit by a probe, drawn by the program's own renderer: what `probe view` shows and `probe compare` holds
// two probes against each other by.
#pragma once

#include <filesystem>
#include <optional>

#include "core/image.h"
#include "core/warnings.h"
#include "gl/context.h"
#include "lighting/probe.h"
#include "scene/scene_file.h"

namespace matchlight {

/// From left to right: matte grey, chrome, metal of roughness 0.2 and 0.5, white plastic.
inline constexpr int balls_in_row = 5;

struct BallRowOptions {
    std::filesystem::path probe;
    std::optional<ProbeMapping> mapping;
    double azimuth_deg = 90;            // where the camera looks: counter-clockwise from world +x seen from above
    double elevation_deg = 8;           // of the camera above the balls
    std::optional<double> exposure_ev;  // absent: shows the grey ball's bright side at 60 % of white
    int ball_px = 192;                  // diameter
    QualityLevel quality = QualityLevel::final_;
};

/// Above: with the probe behind; below: on matte grey ground.
struct BallRow {
    Image8 picture;   // sRGB
    ImageF light;     // linear, × 2^exposure_ev
    Image8 on_balls;  // 1 channel: 255 where a ball is seen
    double exposure_ev = 0;
};

/// Throws InputError.
BallRow draw_ball_row(GlContext& gl, const BallRowOptions& options, Warnings& warnings);

}  // namespace matchlight
