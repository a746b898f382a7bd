// Boards seen through a known lens: corners by projection, and whole pictures by looking up the board's ink for each
// ray.
#pragma once

#include <cstdint>
#include <vector>

#include "calibration/lens_fit.h"
#include "core/image.h"
#include "core/transforms.h"

namespace matchlight::test {

struct SyntheticLens {
    Camera camera;
    std::array<double, 3> bend_m{};
};

/// `count` poses that hold the board in the picture, turned and tilted by up to `most_tilt_deg`; always the same ones.
std::vector<RigidTransform> board_poses(const BoardSpec& board, const Camera& camera, int count, double most_tilt_deg);

/// The corners that lie in the picture, each coordinate off by Gaussian noise of `noise_px`.
LensData synthetic_corners(const BoardSpec& board, const SyntheticLens& lens,
                           const std::vector<RigidTransform>& camera_from_board, double noise_px,
                           std::uint32_t seed = 1);

/// 8-bit sRGB picture of the board on grey, 3 channels; pixels are averages over their area.
Image8 board_photograph(const BoardSpec& board, const Camera& camera, const RigidTransform& camera_from_board);

}  // namespace matchlight::test
