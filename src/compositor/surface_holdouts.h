// Where real things hide the real surface from the camera: what they stand for is no picture of the surface.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "compositor/lens_map.h"
#include "core/content_hash.h"
#include "core/image.h"
#include "core/warnings.h"
#include "scene/model.h"
#include "scene/model_pose.h"
#include "scene/object_motion.h"
#include "scene/scene_file.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// The scene's holdouts.
class SurfaceHoldouts {
public:
    /// Loads their models. Throws InputError.
    SurfaceHoldouts(const Scene& scene, const Solve& solve, Warnings& warnings);

    /// 1 channel over the plate: 255 where one of them may stand before the surface in a frame with a pose. Empty
    /// where none does.
    Image8 before_surface(const SolvedFrame& frame, const LensMap& lens_map) const;

private:
    struct Holdout {
        Model model;
        ObjectSettings settings;
        Eigen::Affine3d world_from_parent;
        PosedModel posed;
    };
    std::vector<Holdout> holdouts_;
    const Camera& camera_;
    double surface_z_m_ = 0;
};

/// Adds what they look like and where they stand in some frames.
void add_holdouts(ContentHash& hash, const Scene& scene, const Solve& solve,
                  std::span<const SolvedFrame* const> frames);

}  // namespace matchlight
