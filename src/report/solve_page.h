// The page of a solve: flagged frames first, then the path, the residuals and what the camera did, in one HTML file.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/image.h"
#include "core/warnings.h"
#include "report/solve_findings.h"
#include "scene/scene_file.h"

namespace matchlight {

struct SolvePageInput {
    const Solve& solve;
    const TrackDetails& details;
    const std::vector<Warnings::Entry>& warnings;
    std::string title;  // the scene's name
    /// A frame of the footage as 8-bit RGB, asked for in ascending order; nullopt where it cannot be decoded.
    std::function<std::optional<Image8>(std::int64_t)> picture;
};

/// Needs nothing else: plots are SVG, at most a dozen frames are inside it with the solve drawn over them.
std::string solve_page_html(const SolvePageInput& input);

/// The same for the scene's footage, which is opened again for the pictures. Throws InputError.
std::string solve_page_html(const Scene& scene, const Solve& solve, const TrackDetails& details, Warnings& warnings);

}  // namespace matchlight
