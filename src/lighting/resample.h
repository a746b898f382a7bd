// Resampling of probes between mappings that keeps uniform light uniform and the energy of every lamp.
#pragma once

#include "core/image.h"
#include "lighting/mappings.h"
#include "lighting/probe.h"

namespace matchlight {

/// How much work goes into a resampling; the defaults are what every command uses.
struct ResampleOptions {
    int points_a_side = 3;           // of the lattice in a pixel of the finer image, at least
    int most_passes = 48;            // over the matrix of overlaps, to balance it
    double energy_tolerance = 2e-4;  // balanced enough when no pixel gains or loses more of its energy
};

/// The picture `source` of layout `from` in layout `to`. Every pixel of the result is the mean, over the solid angle it
/// covers, of the source's pixels (interpolated between where the source is coarser). Pixels of the result that show no
/// direction are 0. The same layout gives the same pixels.
ImageF resample(const ImageF& source, const ProbeLayout& from, const ProbeLayout& to,
                const ResampleOptions& options = {});

/// A probe in any layout, and a lat-long probe of `height` rows from any layout.
ImageF image_from_probe(const Probe& probe, const ProbeLayout& to);
Probe probe_from_image(const ImageF& image, const ProbeLayout& from, int height);

/// A probe as a lat-long map of so many rows.
Probe resized(const Probe& probe, int height);

/// Height of the lat-long map that holds what an image of this layout can show.
int latlong_height_for(const ProbeLayout& layout);

/// The side of a `to` image (as in layout_of_size) that holds what a lat-long map of `latlong_height` rows shows.
int size_for_latlong(ProbeMapping to, int latlong_height);

}  // namespace matchlight
