// Plate pixels that are clipped, and what the clip's other frames know of their light.
//
// A clipped code says only how bright a pixel is at least; its share under a shadow would be too dark. Where no frame
// shows the place unclipped, channels that clip follow from those that do not, by the colour of what lies around.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Geometry>

#include "compositor/lens_map.h"
#include "core/image.h"
#include "render/composite_pass.h"
#include "render/gathered_surface.h"

namespace matchlight {

struct ClippedView {
    const GatheredSurface* gathered = nullptr;  // null: no other frame tells
    double surface_z_m = 0;
    const FrameOptics& optics;
    const LensMap& lens_map;
    /// Whether a part of the surface may be shaded.
    std::function<bool(const Eigen::AlignedBox2d&)> in_shadow;
    /// Linear light of a code of a channel, in the footage's primaries, before any gain of ours.
    std::function<double(float code, int channel)> light_from_code;
    const Eigen::Matrix3d& rec709_from_footage;
};

struct ClippedPlate {
    /// Over the region: plate-linear light that the camera would have seen in a clipped pixel under a shadow, and how
    /// well that is known, 0 to 1. Empty where it is for no pixel.
    ImageF known;
    /// 1 channel, of pixels under a shadow: 1 where one is known only from below, ½ where it has the colour of its
    /// neighbours and the brightness of its own channels that do not clip.
    ImageF bound;
    std::int64_t bounds = 0;      // how many are known only from below
    std::int64_t neighbours = 0;  // how many have their neighbours' colour
};

/// Of the code values (RGB) over `region`, in its runs.
ClippedPlate unclip_plate(const ImageF& code, const Region& region, const std::vector<Region>& runs,
                          const ClippedView& view);

}  // namespace matchlight
