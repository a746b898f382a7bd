// Two fisheye pictures taken back to back, laid onto one sphere: turned and brightened so that they agree where both
// see.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/image.h"
#include "lighting/fisheye_lens.h"
#include "lighting/stitched_sphere.h"

namespace matchlight {

struct FisheyePicture {
    ImageF light;  // scene-linear RGB
    FisheyeLens lens;
    double upright_deg = 0;  // to be turned clockwise by so much
    ImageF clipped = {};     // 1 channel: 1 where the light is a lower bound; empty where nothing is known
};

/// Axes of the pair: x right, y forward along the front lens, z up in the front picture.
Eigen::Matrix3d front_from_pair(const FisheyePicture& front);
/// The back looks along −y, its right along −x.
Eigen::Matrix3d back_from_pair(const FisheyePicture& back);

/// How the back agrees with the front over the ring that both see.
struct PairMatch {
    double overlap_deg = 0;                               // width of the ring
    Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();   // of the back in the pair's axes, as a rotation vector
    Eigen::Vector3d back_gain = Eigen::Vector3d::Ones();  // brings the back's light to the front's, RGB
    double difference_ev = 0, difference_before_ev = 0;   // mean |log2| of back over front, gain set aside
    bool turned = false;                                  // false: the ring did not tell, or was not asked
};

struct MatchOptions {
    bool turn = true;  // find the back's small rotation
    bool gain = true;  // find its gain
    double most_turn_deg = 5;
};

PairMatch match_pair(const FisheyePicture& front, const FisheyePicture& back, const MatchOptions& options);

/// The view of a picture in the stitching; its weight falls to 0 at the rim over `blend` radians.
SphereView view_of(const FisheyePicture& picture, const Eigen::Matrix3d& view_from_world, double blend);

/// Both, or the front alone; world_from_pair turns what is written.
StitchedSphere stitched_pair(const FisheyePicture& front, const FisheyePicture* back, const PairMatch& match,
                             const Eigen::Matrix3d& world_from_pair, int height);

/// Height of the lat-long map that holds what the picture shows in its middle.
int latlong_height_for(const FisheyePicture& picture);

}  // namespace matchlight
