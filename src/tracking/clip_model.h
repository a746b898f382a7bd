// What the frames of a clip have in common, and which of it is unknown: lens, read-out, places and sheets of the tags.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calibration/camera.h"
#include "core/transforms.h"
#include "scene/scene_file.h"
#include "tracking/camera_pose.h"
#include "tracking/lens_projection.h"
#include "tracking/tag_fit.h"

namespace matchlight {

using PoseVector = Eigen::Matrix<double, 6, 1>;  // rotation vector, then translation

struct ModelTag {
    double size_m = 0;
    RigidTransform world_from_tag = RigidTransform::Identity();
    bool held = false;  // its place was given, or it is the origin
    /// Where the corners are seen on the sheet beside where they should be (tag_corners_m), as long as the clip lasts:
    /// print, flatness, glue, light that bleeds. Averaging over frames does not remove it.
    Eigen::Matrix<double, 2, 4> corner_offsets_m = Eigen::Matrix<double, 2, 4>::Zero();
    double metres_per_px = 0;  // on the sheet, at the median distance
    bool on_plane = false;     // lies in ClipModel::world_from_plane's z = 0, as far as is known
};

struct ClipModel {
    Camera camera;
    double readout_s = 0;  // rolling shutter: from the first row to the last
    std::map<int, ModelTag> tags;
    RigidTransform world_from_plane = RigidTransform::Identity();
};

/// Gaussian knowledge of the lens from before the clip.
struct LensPrior {
    LensVector mean = LensVector::Zero();
    LensVector sigma = LensVector::Zero();  // of fy: unused, see aspect
    double aspect_sigma = 0;                // of fy / fx, relative
};

/// What the solver may change, and what it takes as known of noise.
struct ModelFreedom {
    std::array<bool, lens_parameter_count> lens{};
    bool readout = false;
    double readout_sigma_s = 0.04;        // before the clip: up to a frame of film
    std::optional<double> plane_sigma_m;  // how far sheets depart from a common plane; nullopt: no plane is assumed
    double corner_bias_px = 0;            // standard deviation of corner_offsets_m, at the median distance
    double noise_scale = 1;               // of the standard deviations that the fits state
    double noise_floor_px = 0;            // added to the fits' own covariance, independent from frame to frame
    LensPrior prior;
};

}  // namespace matchlight
