// Motion vectors as other programs expect them.
#pragma once

#include "calibration/camera.h"
#include "compositor/lens_map.h"
#include "core/image.h"

namespace matchlight {

/// 4 channels in pixels of the picture, to the right and up: where what is seen at a pixel will be in the next frame
/// and was in the previous one, less where it is. `ways` holds the same as changes of x/z and y/z of a camera without
/// distortion, over `region`.
ImageF motion_px(const ImageF& ways, const Region& region, const Camera& camera, const LensMap& lens_map);

}  // namespace matchlight
