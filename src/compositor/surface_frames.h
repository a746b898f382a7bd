// The frames that the picture of the real surface is gathered from, and what each says of a point of the plane.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calibration/thin_lens.h"
#include "compositor/lens_map.h"
#include "compositor/surface_holdouts.h"
#include "core/image.h"
#include "core/transforms.h"
#include "media/plate.h"
#include "tracking/plate_light.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// Posed frames spread evenly over the clip, the first and the last among them, at most `most`.
std::vector<const SolvedFrame*> spread_frames(const Solve& solve, int most);

/// What one frame says of the light of a point.
struct SurfaceSample {
    std::array<double, 3> radiance{};   // probe units; of a clipped channel the bound from below
    std::array<double, 3> deviation{};  // standard: of noise, of the pose, and of the light's model
    std::array<bool, 3> clipped{};
    double weight = 0;
};

/// What the frames share.
struct SurfaceClip {
    SurfaceClip(const Solve& the_solve, const std::array<double, 2>& the_vignette, const PlateFormat& format);

    const Solve& solve;
    LensMap lens_map;
    PlateLight light;
    std::array<double, 2> vignette;
    double code_step = 1.0 / 255;               // of the footage's depth
    const SurfaceHoldouts* holdouts = nullptr;  // null: the scene has none
};

/// One frame, decoded and placed.
class SurfaceFrame {
public:
    /// `clip` outlives this. `solved` has a pose.
    SurfaceFrame(const SurfaceClip& clip, const PlateFrame& plate, const SolvedFrame& solved);

    /// The mean over a texel about `point_m` of the plane; nullopt where the frame does not see it.
    std::optional<SurfaceSample> sample(const Eigen::Vector3d& point_m, double texel_m) const;

private:
    /// Adds the light about a pixel's place; false beyond the frame, and where the surface is hidden.
    bool add_taps(const Eigen::Vector2d& pixel, SurfaceSample& sum) const;

    const SurfaceClip& clip_;
    RigidTransform camera_from_world_;
    Eigen::Vector3d eye_m_;
    Eigen::Vector3d gain_;
    Focus focus_;
    Image16 code_;
    Image8 hidden_;  // 255 where something else stands before the surface; empty: nowhere
};

}  // namespace matchlight
