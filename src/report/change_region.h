// Where two pictures of one scene really differ, beyond noise.
#pragma once

#include "core/image.h"

namespace matchlight {

/// The region that the objects change: pixels that differ from the plate by more than 10 codes in some channel, cleared
/// of lone pixels by a 5 × 5 median, grown by a 15 × 15 square. 1 channel, 255 inside.
Image8 change_region(const Image8& plate, const Image8& with_objects);

}  // namespace matchlight
