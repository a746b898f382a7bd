// A picture that goes on beyond the footage's frame, as much to the left as to
// the right.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "core/image.h"
#include "scene/effects.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// Pixels on each side.
struct Overscan {
    int x = 0, y = 0;

    bool any() const { return x > 0 || y > 0; }
    /// The whole picture, in pixels of the frame.
    Region window(int frame_width, int frame_height) const {
        return {-x, -y, frame_width + 2 * x, frame_height + 2 * y};
    }
};

/// What a caller asked for: a share of width and height, or pixels.
struct OverscanRequest {
    double share = 0;
    int pixels = 0;

    /// Whole pixels, at least as many as asked for.
    Overscan of(int frame_width, int frame_height) const;
};

/// "5%", "64" or "64px": up to 100 % and 4096 px; nullopt for anything else.
std::optional<OverscanRequest> parse_overscan(const std::string& text);

/// The solve for a camera that sees that much more, with the same lens about
/// the same axis.
Solve with_overscan(const Solve& solve, const Overscan& overscan);
/// The camera that the solve had before.
Camera without_overscan(const Camera& camera, const Overscan& overscan);
/// The effects with the sizes that they have in the frame alone: settings count
/// in heights and diagonals of the picture.
EffectSettings with_overscan(const EffectSettings& effects, const Camera& frame, const Overscan& overscan);
/// How much farther off the picture's corner is than the frame's.
double corner_ratio(const Camera& frame, const Overscan& overscan);

}  // namespace matchlight
