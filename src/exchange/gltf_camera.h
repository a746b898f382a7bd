// An animated camera and the rig's tags as glTF 2.0, which Blender, Houdini and the web read.
#pragma once

#include <string>

#include "exchange/camera_track.h"

namespace matchlight {

/// y-up, metres, seconds. The camera's node is animated (translation, rotation; linear between frames), with
/// a perspective of the picture's height; each tag is a quad, "tag_0", …. Frames without a pose have no key, so players
/// move straight over a gap: their numbers stand in the camera node's `extras`.
std::string gltf_camera_text(const CameraTrack& track);
/// The same, as one binary file (.glb).
std::string glb_camera_bytes(const CameraTrack& track);

}  // namespace matchlight
