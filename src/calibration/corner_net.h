// Corners known so far, and what they say about where the others are: a board bends in a picture, but smoothly.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calibration/board_detector.h"

namespace matchlight {

/// A place of the board with its pixel.
struct BoardAnchor {
    Eigen::Vector2d board_m;
    Eigen::Vector2d px;
};

/// Homography that maps board metres to pixels, fitted to anchors (normalised direct linear transform, Hartley &
/// Zisserman, "Multiple View Geometry", 2004, 4.4); nullopt for fewer than four or for points on a line.
std::optional<Eigen::Matrix3d> homography_of(const std::vector<BoardAnchor>& anchors);

struct LocalView {
    Eigen::Vector2d px;
    Eigen::Matrix2d px_from_board;  // derivative
};
/// Where `board_m` lies by the `count` nearest anchors alone, so that the lens's bending elsewhere does not count.
std::optional<LocalView> local_view(const std::vector<BoardAnchor>& anchors, const Eigen::Vector2d& board_m,
                                    std::size_t count);

/// Measures corner `index` near `view` and adds it; false where the picture shows no crossing there.
bool measure_corner(const BoardPicture& picture, const LocalView& view, double radius_m, int index,
                    std::vector<BoardCorner>& corners);

/// Sorts by index and fills in the sighting's median blur.
void finish_sighting(BoardSighting& sighting);

}  // namespace matchlight
