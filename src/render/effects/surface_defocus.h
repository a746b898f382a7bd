// The real surface's shadow through the lens: blurred by the surface's own circle of confusion.
//
// The plate's texture carries the lens' blur already; what objects take of its light, and return, has to get it. The
// surface is a plane, on which the circle is an affine function of the pixel (but for what the lens bends): the mean
// over the opening is a gather over an ellipse, with exact weights, and scatter is the same light. Pixels are sorted by
// the width of their circle into classes that double from one to the next, each gathered on texels as coarse as its
// circles allow. The shadow is looked up beyond the frame, too. The mean of light times shadow is taken as the product
// of their means. The double-precision reference is report/surface_defocus_reference.h.
#pragma once

#include <vector>

#include "gl/objects.h"
#include "gl/shader_library.h"
#include "render/composite_pass.h"
#include "render/graph.h"
#include "scene/scene_file.h"

namespace matchlight {

/// What trades error for time.
struct SurfaceDefocusKnobs {
    double class_texels = 6;  // least diameter of a circle on texels coarser than a pixel; the widest are twice as wide
    int texel_samples = 4;    // at most, of the shadow along a texel's side
    /// Where the shadow bends by no more than this share of the light (ShadowDetail), texels may be as coarse as it is
    /// smooth: an eighth of it is what is lost, here a code of 8 bits. 0: nowhere.
    double smooth_bend = 8 * 0.004;

    /// Throws std::invalid_argument naming what is out of range.
    void check() const;
};
SurfaceDefocusKnobs surface_defocus_knobs(QualityLevel quality);

/// A part of the frame that the blurred shadow can reach, and the surface's circles of confusion over it.
struct SurfaceTile {
    Region pixels;
    double narrowest_px = 0, widest_px = 0;
    int least_class = 0;  // of which circles are drawn, however narrow: the shadow is smooth here
};

/// The most that smooth parts take texels of 2^this pixels.
inline constexpr int coarsest_smooth_class = 4;

struct SurfaceDefocusInput {
    CompositeInput input;  // its optics tell focus and frame; has a shadow
    double focal_px = 1;   // of the lens without its distortion
    BokehSettings bokeh;
    std::vector<SurfaceTile> tiles;  // disjoint
    Region region;                   // what is written covers
};

/// Wider circles of confusion, which cover the frame from any place in it, are as this.
double widest_surface_coc_px(int frame_width, int frame_height);

/// Circles on a plane seen aslant grow to one side; an ellipse that grows by more than this over its radius is cut off
/// there.
inline constexpr double most_surface_stretch = 1.5;

/// How far from a pixel the shadow lies that it sees, where the surface's circle is `coc_px` wide and changes by
/// `change` from pixel to pixel.
double surface_reach_px(double coc_px, double change, int least_class, const SurfaceDefocusKnobs& knobs);

class SurfaceDefocus {
public:
    explicit SurfaceDefocus(ShaderLibrary& shaders) : shaders_(shaders) {}

    /// RGBA32F: RGB share of the surface's light that is left, a = 1; 1 outside of the tiles. Where circles are
    /// narrower than least_coc_px the shadow is CompositePass::add_shadow_ratio()'s, bit for bit.
    GraphTexture add(RenderGraph& graph, const CompositePass& composite, const SurfaceDefocusInput& input,
                     const SurfaceDefocusKnobs& knobs);

private:
    class Passes;
    void make_discs(const BokehSettings& bokeh, const SurfaceDefocusKnobs& knobs);

    ShaderLibrary& shaders_;
    Texture2D discs_;  // of the settings last used
    std::vector<Eigen::Vector4f> taps_;
    int taps_reach_ = 0;
    BokehSettings bokeh_;
    double class_texels_ = 0;
};

}  // namespace matchlight
