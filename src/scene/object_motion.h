// Where a scene's object stands at a time: as it was placed, on its way through its keys, or spinning.
#pragma once

#include <Eigen/Geometry>

#include "scene/scene_file.h"

namespace matchlight {

/// A time of a clip, in frames and in seconds.
struct ClipTime {
    double frame = 0;
    double time_s = 0;
};

/// Whether it stands otherwise at some times than at others.
bool moves(const ObjectSettings& object);

/// World (or parent tag) from model: scale first, then rotation, then translation; a pure function of the time.
/// Translation and the logarithm of scale follow cubic Hermite curves through the keys, as the virtual camera does.
/// From key to key an object turns about one axis, by as many full turns more than the shortest way as brings it
/// nearest to the difference of the keys' degrees (0 to 360 is a full turn, 0 to 350 is not ten degrees back), along
/// cubic Hermite quaternion curves (Kim, Kim & Shin 1995, "A General Construction Scheme for Unit Quaternion Curves
/// with Simple High Order Derivatives"), so that no key shows as a jerk.
Eigen::Affine3d object_placement(const ObjectSettings& object, const ClipTime& time);

}  // namespace matchlight
