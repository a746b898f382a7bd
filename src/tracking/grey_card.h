// A tag's paper and ink as a grey card: how much light they send to the camera, and how it is coded.
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

/// The code values (0..1 of full scale) of paper or of ink in one channel, at the tag's centre.
struct CardCode {
    double code = 0;
    double standard_error = 0;
    double noise = 0;                  // standard deviation of one pixel
    double neighbour_correlation = 0;  // of the noise of horizontal neighbours
    int noise_freedom = 0;             // degrees of freedom behind `noise`; 0: not known
    bool clipped = false;
};

/// Linear plate light that a tag's surfaces send, per channel, and the codes it was read from.
struct CardReading {
    int id = 0;
    /// Paper minus ink: what lies on both alike (gloss, veiling glare) drops out.
    std::array<CardLight, 3> difference;
    /// Ink alone, which is still seen when paper is clipped.
    std::array<CardLight, 3> ink;
    std::array<CardCode, 3> paper_code, ink_code;
    /// Covariance between the noise of red and green, green and blue, blue and red (code²).
    std::array<double, 3> paper_shared{}, ink_shared{};
    bool chroma_shared = false;  // neighbours share chroma: the channels' noise is never independent
    double radius = 0;           // of the tag's centre from the frame's; 1 = the frame's corner
    double code_step = 0;        // between neighbouring codes of the footage
};

/// Reads pixels that see nothing but paper, or nothing but ink: at least 2.5 px from any edge where the cells are large
/// enough (chroma is shared by two pixels), outside the fitted blur in any case. Each cell gives a mean that a glint
/// inside it does not move; a plane through the cells, robust against those in a shadow, gives the value at the centre.
/// nullopt when the tag is too small or blurred for that, or lies partly outside.
std::optional<CardReading> read_card(const PlateFrame& frame, const PlateLight& plate_light, const LensGrid& lens,
                                     const TagPattern& tag, const TagImageFit& fit);

}  // namespace matchlight
