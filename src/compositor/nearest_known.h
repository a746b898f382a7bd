// What a frame does not know of the camera is taken from the nearest one that does.
#pragma once

#include <cstdlib>
#include <optional>

#include "tracking/solve_file.h"

namespace matchlight {

/// The frame's own `value`, else that of the frame nearest in time that knows it.
inline std::optional<double> known_near(const Solve& solve, const SolvedFrame& frame,
                                        std::optional<double> SolvedFrame::*value) {
    if (frame.*value) return frame.*value;
    const SolvedFrame* nearest = nullptr;
    for (const SolvedFrame& other : solve.frames) {
        if (!(other.*value)) continue;
        if (nearest == nullptr || std::abs(other.frame - frame.frame) < std::abs(nearest->frame - frame.frame))
            nearest = &other;
    }
    return nearest != nullptr ? nearest->*value : std::nullopt;
}

}  // namespace matchlight
