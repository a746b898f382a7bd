// Lateral chromatic aberration: the lens magnifies red and blue otherwise than green.
//
// Red and blue lie displaced along the radius, in proportion to it: a difference of magnification is all there is to
// the first order (Mallon & Whelan 2007, "Calibration and removal of lateral chromatic aberration in images"; higher
// orders are left out). The virtual layer is displaced with its coverage, channel by channel, so that a black object
// before a white plate has coloured fringes as a white one before a black plate has.
#pragma once

#include <Eigen/Core>

#include "gl/shader_library.h"
#include "render/graph.h"
#include "render/virtual_layer.h"
#include "scene/effects.h"
#include "scene/scene_file.h"

namespace matchlight {

/// Displacements of less, in plate pixels, are none; they set in up to twice as much, so that nothing jumps.
inline constexpr double least_aberration_px = 0.25;

/// Away from the middle of the frame, in plate pixels at its corners.
struct LateralColor {
    double red_px = 0, blue_px = 0;
    int frame_width = 0, frame_height = 0;

    /// The larger of both at a pixel, as it is drawn: 0 where it counts as none.
    double displacement_px(const Eigen::Vector2d& pixel) const;
    /// Whether nothing in the region is displaced.
    bool is_none(const Region& region) const;
};

struct ChromaticAberrationKnobs {
    bool cubic = true;  // Keys 1981, held within the four nearest texels; false: bilinear
};
ChromaticAberrationKnobs chromatic_aberration_knobs(QualityLevel level);

/// What is displaced of `layer` (its light over any region; coverage empty): the same with a coverage of its own for
/// each channel. Light of green and the alpha stay as they are, bit for bit.
PlateLayer add_chromatic_aberration(RenderGraph& graph, ShaderLibrary& shaders, const PlateLayer& layer,
                                    const LateralColor& color, const ChromaticAberrationKnobs& knobs);

}  // namespace matchlight
