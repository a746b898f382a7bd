// What a frame does not know of the camera is taken from the nearest one that does.
#pragma once

#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>

#include <Eigen/Core>

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

/// Plate light of unit probe light, 2^ev · white balance, of the frame or the one nearest that knows its exposure; 1
/// where none does.
inline Eigen::Vector3d gain_near(const Solve& solve, const SolvedFrame& frame) {
    const SolvedFrame* exposed = solve.exposed_near(frame);
    if (exposed == nullptr) return Eigen::Vector3d::Ones();
    const std::array<double, 3> balance = exposed->white_balance.value_or(std::array<double, 3>{1, 1, 1});
    return std::exp2(*exposed->exposure_ev) * Eigen::Vector3d(balance[0], balance[1], balance[2]);
}

}  // namespace matchlight
