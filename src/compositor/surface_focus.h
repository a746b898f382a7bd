// How far the real surface is out of focus over a frame's tiles.
#pragma once

#include "calibration/camera.h"
#include "calibration/thin_lens.h"
#include "compositor/lens_map.h"
#include "core/image.h"
#include "core/transforms.h"
#include "render/effects/surface_defocus.h"

namespace matchlight {

/// The plane z = `surface_z_m` of the world as a lens sees it.
class SurfaceFocus {
public:
    /// `lens_map` outlives this.
    SurfaceFocus(const Focus& focus, double surface_z_m, const RigidTransform& camera_from_world,
                 const LensMap& lens_map, const Camera& camera);

    /// False where the lens lies in the plane: nothing of it is seen.
    bool is_seen() const { return height_m_ != 0; }
    /// Of a lens that bends nothing.
    double focal_px() const { return focal_px_; }
    /// Signed diameter in plate pixels, as shaders/effects/depth_of_field/surface_circle.glsl has it; NaN where the
    /// lens model does not reach.
    double coc_px(double x, double y) const;
    /// Over a part of the frame. What lies beyond the reach of the lens model is taken as all there could be.
    SurfaceTile over(const Region& part) const;
    /// The coarsest class whose texels are, anywhere in the part, no larger on the surface than this.
    int class_of_texels(const Region& part, double texel_m) const;
    /// How far the part's pixels look for the shadow, of a class no finer than `least_class`.
    int reach_px(const Region& part, int least_class, const SurfaceDefocusKnobs& knobs) const;

private:
    double bare_coc_px(const Eigen::Vector2d& normalized) const;

    Focus focus_;
    Eigen::Vector3d up_;   // the plane's normal in the camera's axes
    double height_m_ = 0;  // of the plane above the lens
    const LensMap* lens_map_;
    double focal_px_ = 1, largest_px_ = 0;
};

}  // namespace matchlight
