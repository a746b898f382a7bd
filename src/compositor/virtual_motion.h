// How far things move in the picture while the shutter is open.
#pragma once

#include "calibration/camera.h"
#include "compositor/lens_map.h"
#include "compositor/scene_objects.h"
#include "compositor/shutter.h"
#include "render/surface.h"

namespace matchlight {

/// Bounds in plate pixels, of everything that a frame shows.
struct MotionExtent {
    double way_px = 0;     // from the shutter's opening to its closing
    double spread_px = 0;  // from mid-exposure to any time between

    void extend(const MotionExtent& other);
};

/// Of the corners of every object's box, and of all vertices where they move against each other; those behind the near
/// plane are taken to it.
MotionExtent object_motion_extent(const SurfaceRenderer& surfaces, SceneObjects& objects, const FrameShutter& shutter,
                                  const Camera& camera);
/// Of the real surface at height `z_m`, where the frame sees it.
MotionExtent surface_motion_extent(double z_m, const FrameShutter& shutter, const LensMap& lens_map,
                                   const Camera& camera);

}  // namespace matchlight
