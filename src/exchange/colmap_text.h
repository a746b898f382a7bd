// COLMAP's text model: cameras.txt, images.txt and points3D.txt, with the tags' corners as points.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "exchange/camera_track.h"

namespace matchlight {

/// Names of the files, in the order of colmap_texts.
std::vector<std::string> colmap_file_names();

/// The lens with its distortion as PINHOLE, OPENCV, FULL_OPENCV or OPENCV_FISHEYE; COLMAP's pixel centres lie at one
/// half. Images are those with a pose, named by `image_names`, a pattern with the frame's number. A point is a corner
/// of a tag; the solve keeps no observations, so where an image saw the tag the point's own projection stands for one.
/// Throws InputError (naming `reported`): thin-prism or tilt coefficients, which no model of COLMAP holds.
std::vector<std::string> colmap_texts(const CameraTrack& track, const std::filesystem::path& image_names,
                                      const std::filesystem::path& reported);

}  // namespace matchlight
