// One camera pose from the pixels of all placed tags at once, through the motion of the exposure.
#pragma once

#include <optional>
#include <vector>

#include "tracking/rig_image_model.h"
#include "tracking/tag_pixels.h"

namespace matchlight {

/// A sheet that correlates less with its model is hidden, or not there.
inline constexpr double least_sheet_correlation = 0.9;

struct RigFitOptions {
    double search_px = 0;  // how far off the start may be in the picture
    std::size_t most_pixels_a_tag = 1000;
};

/// What the fit says of one sheet.
struct FittedSheet {
    const PlacedSheet* sheet = nullptr;
    double correlation = 0;  // of the light with the model's
    double contrast = 0;     // light of paper minus ink
    double streak_px = 0;    // that its middle travelled during the exposure
    std::size_t pixels = 0;
};

struct RigImageFit {
    MovingCamera camera;
    PoseCovariance covariance = PoseCovariance::Zero();  // of camera.camera_from_world
    /// How the pose follows the motion's bend (MovingCamera::at + ½·bend·time²), which the fit takes as none: a camera
    /// that speeds up is not in the middle of its streak at mid-exposure.
    PoseCovariance pose_by_bend = PoseCovariance::Zero();
    double correlation = 0;           // over all sheets
    std::vector<FittedSheet> sheets;  // that were in view
};

/// Fits the pose at mid-exposure (6), the motion during it (6), one blur for all else, and light of paper and ink with
/// its slope for each sheet (4) to the light of `source`, robustly. The motion is even over the exposure; its sign
/// cannot be seen. First the picture is searched for the arrangement of tags around `start`, for motions that are
/// several multiples of `start.motion`; then the best places are refined. nullopt when the pixels do not show the rig,
/// or when two different poses explain them about equally.
std::optional<RigImageFit> fit_rig_image(const FitSource& source, const std::vector<PlacedSheet>& sheets,
                                         const MovingCamera& start, const RigFitOptions& options);

}  // namespace matchlight
