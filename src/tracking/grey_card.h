// A tag's paper and ink as a grey card: how much light they send to the camera.
#pragma once

#include <array>
#include <optional>

#include "tracking/plate_light.h"
#include "tracking/tag_fit.h"

namespace matchlight {

/// Linear plate light of paper minus that of ink. What lies on both alike (gloss, veiling glare) drops out of the
/// difference.
struct CardReading {
    int id = 0;
    std::array<double, 3> difference{};      // per channel
    std::array<double, 3> relative_error{};  // standard error of `difference` over it
    std::array<bool, 3> usable{};            // false where paper is clipped in that channel, or ink as light as paper
};

/// Interquartile means over pixels that see nothing but paper, or nothing but ink: at least 2.5 px from any edge where
/// the cells are large enough (chroma is shared by two pixels), outside the fitted blur in any case. nullopt when the
/// tag is too small or blurred for that, or lies partly outside.
std::optional<CardReading> read_card(const PlateFrame& frame, const PlateLight& plate_light, const LensGrid& lens,
                                     const TagPattern& tag, const TagImageFit& fit);

}  // namespace matchlight
