// What is infinitely far away through the lens: everything becomes a disc of one circle of confusion.
//
// A convolution with the opening's shape, normalised: a sun keeps its light. Wide discs are gathered on coarser texels.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "gl/shader_library.h"
#include "render/graph.h"
#include "scene/scene_file.h"

namespace matchlight {

/// What trades error for time.
struct BackgroundDefocusKnobs {
    double disc_texels = 8;  // least diameter of a disc on texels coarser than a pixel; the widest is twice as wide

    /// Throws std::invalid_argument naming what is out of range.
    void check() const;
};
BackgroundDefocusKnobs background_defocus_knobs(QualityLevel quality);

/// A disc on texels of `texel_px` frame pixels.
struct EvenDisc {
    int texel_px = 1;
    int reach = 0;                      // texels
    std::vector<Eigen::Vector4f> taps;  // offset, share of the light; shares sum to 1
};
/// `coc_px` from beyond the focus; narrower than least_coc_px it is none, and the one tap is the texel itself. Wider
/// than twice the frame's diagonal it is as that.
EvenDisc even_disc(const BokehSettings& bokeh, double coc_px, const Region& frame, const BackgroundDefocusKnobs& knobs);

/// Draws light over a region, in texels of so many pixels; it may leave the frame.
using AddFarLight = std::function<GraphTexture(const Region& texels, int texel_px)>;

/// RGBA32F over the frame.
GraphTexture add_background_defocus(RenderGraph& graph, ShaderLibrary& shaders, const AddFarLight& add_light,
                                    const EvenDisc& disc);

}  // namespace matchlight
