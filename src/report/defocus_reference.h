// The post-process methods of depth of field in double precision, as straightforward as they can be written.
//
// Each is held against its own formulas; what a method is worth is its distance to the scene drawn from many points of
// the lens. Frames end where the picture ends.
#pragma once

#include <span>
#include <vector>

#include "render/effects/defocus_taps.h"
#include "report/bright_reference.h"

namespace matchlight {

/// What is blurred: premultiplied light with coverage, and signed circles of confusion in px, NaN where nothing is.
struct DefocusImages {
    ImageD light;
    ImageD coc_px;

    DefocusImages(int width, int height);
    bool covered(int x, int y) const;
    /// Something opaque of one brightness.
    void set(int x, int y, double value, double signed_coc_px);
};

/// Zhou, Chen & Pullen 2007, across and then down.
ImageD reference_two_pass(const DefocusImages& images, double largest_radius_px);

/// The same weights in one gather over the taps; disc_taps() is what rings converge to.
ImageD reference_one_pass(const DefocusImages& images, std::span<const DefocusTap> taps, double largest_radius_px);

/// Kass, Lefohn & Owens 2006, across and then down, each step of `steps` with its share of the conductivity.
ImageD reference_diffusion(const DefocusImages& images, int steps);

/// Scofield 1992: each slice blurred by its own opening, on whole pixels, then put before those behind it.
struct SlicedReference {
    std::vector<DefocusSlice> slices;  // back to front
    BokehSettings bokeh;
    bool disjoint = true;  // as LayersKnobs
};
ImageD reference_layers(const DefocusImages& images, const SlicedReference& sliced);

/// Lee, Kim & Choi 2009, with so many levels.
ImageD reference_mipmap(const DefocusImages& images, int levels);

}  // namespace matchlight
