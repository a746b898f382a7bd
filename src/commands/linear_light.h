// Light for a probe: bracketed photographs merged, or one picture that is linear already.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "calibration/hdr_merge.h"
#include "commands/photograph_options.h"
#include "core/image.h"
#include "core/warnings.h"

namespace matchlight {

/// How photographs are read; the same for all series of a command.
struct LightOptions {
    std::string response = "srgb";
    PhotographOptions exposures;  // without photographs
    Alignment align = Alignment::automatic;
    bool deghost = false;  // around small lamps photographs differ by the lens' and JPEG's blur, and energy would go
};
/// --response, --times, --f-numbers, --iso, --deghost.
void add_light_options(CLI::App& command, LightOptions& options);

struct LinearLight {
    ImageF light;         // RGB, scene-linear; of photographs, light that gives code 1 at exposure E is 1/E
    double exposure = 1;  // of the reference photograph; 1 for a linear file
    ImageF clipped;       // 1 channel: 1 where the light is a lower bound; empty for a linear file
    std::int64_t clipped_pixels = 0;
    std::string sources;  // for the metadata
};

/// One .exr or .hdr, or photographs of one scene from one place. Throws InputError.
LinearLight read_light(const std::vector<std::filesystem::path>& files, const LightOptions& options,
                       Warnings& warnings);

}  // namespace matchlight
