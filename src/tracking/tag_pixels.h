// The pixels a tag's fit rests on: which are gathered, and which turn out to show something else.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
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

/// Every `step`th pixel of a row (whole numbers or not), rows shifted against each other by the golden ratio so that no
/// edge is met in one phase only.
template <class Visit>
void visit_pixels(const Region& box, double step, Visit visit) {
    for (int y = box.y; y < box.y + box.height; ++y) {
        double shift = 0;
        if (step > 1) shift = step * std::fmod((y - box.y) * (std::numbers::phi - 1), 1.0);
        for (double offset = shift; offset < box.width; offset += step) visit(box.x + static_cast<int>(offset), y);
    }
}

/// Pixels on cells whose neighbourhood is known.
std::vector<TagPixel> gather_pixels(const FitSource& source, const TagImageModel& model,
                                    const TagParameters::Vector& start, const PixelChoice& choice);

/// Paper and ink that fit best for given geometry, flat over the tag, and the squares that remain.
struct FlatLight {
    double paper = 0, ink = 0, squares = 0;
};
/// Over the pixels that are not hidden.
FlatLight fit_flat_light(const TagImageModel& model, const TagParameters::Vector& parameters,
                         const std::vector<TagPixel>& pixels);

/// What the even parts of half cells say about the fit.
struct CellCheck {
    bool changed = false;     // other pixels are marked hidden than before
    double hidden_share = 0;  // of the half cells that were looked at: neither paper nor ink as expected
    double ink_for_paper_share = 0, paper_for_ink_share = 0;  // another tag, or none; one of them alone: a dark or a
                                                              // light thing in front
};

/// Marks the pixels of half cells whose mean light is off by more than blur or noise can explain, and their
/// neighbours: a hand, a shadow's core, a glint. Edges are not judged: blur of any shape shows there.
CellCheck check_cells(const TagImageModel& model, const TagParameters::Vector& parameters, double residual_scale,
                      std::vector<TagPixel>& pixels);

/// Before a fit, from a start that is right within half a cell: the paper and ink that most half cells agree on, and
/// the others marked hidden. A hand may cover almost half of the tag, where a fit would follow its outline.
void hide_by_vote(const TagImageModel& model, const TagParameters::Vector& parameters, std::vector<TagPixel>& pixels);

}  // namespace matchlight
