// A tag's paper and ink as a grey card: how much light they send to the camera.
#pragma once

#include <array>
#include <optional>

#include "tracking/plate_light.h"
#include "tracking/tag_fit.h"

namespace matchlight {

/// A light of one channel with its standard error; unusable where it is clipped or not above zero.
struct CardLight {
    double light = 0;
    double relative_error = 0;
    bool usable = false;
};

/// Linear plate light that a tag's surfaces send, per channel.
struct CardReading {
    int id = 0;
    /// Paper minus ink: what lies on both alike (gloss, veiling glare) drops out.
    std::array<CardLight, 3> difference;
    /// Ink alone, which is still seen when paper is clipped.
    std::array<CardLight, 3> ink;
};

/// Interquartile means over pixels that see nothing but paper, or nothing but ink: at least 2.5 px from any edge where
/// the cells are large enough (chroma is shared by two pixels), outside the fitted blur in any case. nullopt when the
/// tag is too small or blurred for that, or lies partly outside.
std::optional<CardReading> read_card(const PlateFrame& frame, const PlateLight& plate_light, const LensGrid& lens,
                                     const TagPattern& tag, const TagImageFit& fit);

}  // namespace matchlight
