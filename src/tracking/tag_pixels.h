// The pixels a tag's fit rests on: which are gathered, and which turn out to show something else.
#pragma once

#include <cstddef>
#include <vector>

#include "calibration/camera.h"
#include "core/image.h"
#include "tracking/lens_grid.h"
#include "tracking/tag_image_model.h"

namespace matchlight {

/// The pixels that the grid of `cells` × `cells` covers; empty where the lens does not reach or the tag crosses the
/// camera's horizon.
Region region_of_grid(const Eigen::Matrix3d& grid_from_normalized, int cells, const Camera& camera);

/// The part of a plate that a fit looks at.
struct FitSource {
    const ImageF& light;  // linear
    int x = 0, y = 0;     // of its first pixel, in the plate
    const LensGrid& lens;
    double clipped_light = 1;  // the level above which light is only a lower bound
};

struct PixelChoice {
    double band_px = 0;    // all pixels this near to an edge are wanted, and every sixteenth elsewhere
    std::size_t most = 0;  // about: where there are more, evenly spread ones are taken
};

/// Pixels on cells whose neighbourhood is known.
std::vector<TagPixel> gather_pixels(const FitSource& source, const TagImageModel& model,
                                    const TagParameters::Vector& start, const PixelChoice& choice);

/// Paper and ink that fit best for given geometry, flat over the tag, and the squares that remain.
struct FlatLight {
    double paper = 0, ink = 0, squares = 0;
};
FlatLight fit_flat_light(const TagImageModel& model, const TagParameters::Vector& parameters,
                         const std::vector<TagPixel>& pixels);

/// What the even parts of half cells say about the fit.
struct CellCheck {
    bool changed = false;       // other pixels are marked hidden than before
    double hidden_share = 0;    // of the half cells that were looked at: neither paper nor ink as expected
    double inverted_share = 0;  // paper where ink was expected, or the reverse: another tag, or none
};

/// Marks the pixels of half cells whose mean light is off by more than blur or noise can explain, and their
/// neighbours: a hand, a shadow's core, a glint. Edges are not judged: blur of any shape shows there.
CellCheck check_cells(const TagImageModel& model, const TagParameters::Vector& parameters, double residual_scale,
                      std::vector<TagPixel>& pixels);

}  // namespace matchlight
