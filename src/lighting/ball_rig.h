// Where the cameras of ball photographs stood, by the tags around the ball.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/warnings.h"
#include "lighting/ball_view.h"
#include "scene/scene_file.h"
#include "tracking/rig_image_model.h"

namespace matchlight {

/// Tags that have a place.
struct BallRig {
    std::vector<PlacedSheet> sheets;
};

/// Which sheet's cell a place on the tags' plane lies on: index of the sheet, and whether it prints paper.
struct Print {
    std::size_t sheet = 0;
    bool paper = false;
};
std::optional<Print> print_at(const BallRig& rig, const Eigen::Vector3d& place_m);

/// Sets camera_from_world of every view. Tags are detected and the rig is fitted to each picture as a whole, also to
/// tags that the ball or the frame's edge cuts. A view that shows no whole tag is found by the ball: another view says
/// where it lies in the world, its outline how far from this camera, so that only the camera's turn about it is sought.
/// Throws InputError: no tag in any view, a view that does not show the rig.
BallRig find_rig(std::vector<BallView>& views, const TagSettings& tags, double ball_radius_m, Warnings& warnings);

}  // namespace matchlight
