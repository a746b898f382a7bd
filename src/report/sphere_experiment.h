// Measures sphere sets over orbits: `matchlight report --spheres`.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/warnings.h"
#include "report/report.h"

namespace matchlight {

struct SphereExperimentOptions {
    /// Of an orbit; the part that peels layers takes at most `most_peeled_frames`.
    std::size_t frames = 180;
    int repeats = 1;     // of each frame
    bool quick = false;  // fewer ways, and few pixels are held against rays
    int side_px = 1024;
    std::vector<std::string> parts;  // of sphere_experiment_parts; all when empty
    std::function<void()> advance;   // after each orbit; may be empty
};
inline constexpr std::size_t most_peeled_frames = 6;
inline constexpr std::array sphere_experiment_parts{"visibility", "light",     "maps",  "rays",        "edges",
                                                    "detail",     "occlusion", "halos", "transparency"};
std::size_t sphere_experiment_steps(std::size_t sets);

/// `names` are those of the study's sets (C1 to C4) or files. Each is loaded, measured and let go before the next. Adds
/// to the report. Needs a current context. Throws InputError.
void measure_spheres(const std::vector<std::string>& names, const SphereExperimentOptions& options, Warnings& warnings,
                     Report& report);

}  // namespace matchlight
