// Nuke's .chan: a line a frame, in a y-up world.
#pragma once

#include <string>

#include <Eigen/Core>

#include "exchange/camera_track.h"

namespace matchlight {

/// "frame tx ty tz rx ry rz vfov": metres and degrees; a camera that looks along −z with y up; rotation order ZXY,
/// which turns about z first, then x, then y (R = Ry·Rx·Rz), as Nuke's cameras do unless told otherwise. Angles run on
/// from frame to frame without jumps of 360°. Frames without a pose are left out.
std::string nuke_chan_text(const CameraTrack& track);

/// Angles (degrees, about x, y, z) of R = Ry·Rx·Rz that lie nearest to `near_deg`. Where x is ±90° and only a sum of
/// the other two is defined, y stays where it was.
Eigen::Vector3d zxy_angles_deg(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& near_deg);

}  // namespace matchlight
