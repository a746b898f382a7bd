// One tag before a moving camera, of one size, tilt, blur and noise: how well ours and other poses find it.
#pragma once

#include <optional>

namespace matchlight {

struct TagPoseTrial {
    double side_px = 100;    // of the tag, where it is seen head-on
    double tilt_deg = 30;    // 0 is head-on
    double defocus_px = 0;   // circle of confusion, diameter
    double motion_px = 0;    // during the exposure, across the picture
    double noise_codes = 0;  // of the picture, standard deviation of its 8-bit codes
    double noise_px = 0;     // in place of a picture: of each corner's coordinates, standard deviation
    int frames = 8;
};

/// Errors are in pixels at a point one tag size above the middle of the tag, RMS over the frames; absent where there
/// was no pose in any.
struct TagPoseErrors {
    std::optional<double> ours, apriltag_light, apriltag_codes, ippe;
    int found = 0;                        // frames with a pose of ours
    int found_in_codes = 0;               // by AprilTag in the coded picture
    int mirrored = 0, ippe_mirrored = 0;  // frames with the wrong one of the two planar poses
    double over_claimed = 0;   // largest error of ours over the standard deviation that its own covariance claims
    double noise_px = 0;       // what noise alone must cost: the Cramér–Rao bound of a frame on its own
    double allowance_px = 0;   // what errors of 0.02 px of each corner, which the solve allows for, would cost
    double edge_noise_px = 0;  // how far the picture's noise moves an edge in one row of pixels across it
};

/// With corners instead of a picture `apriltag_light` and `ippe` see the same ones as we do.
TagPoseErrors try_tag_pose(const TagPoseTrial& trial);

}  // namespace matchlight
