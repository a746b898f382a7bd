// How much light the fibres of cloth send back.
#pragma once

#include "core/image.h"

namespace matchlight {

/// The value for `light` and `eye`, unit directions by their cosines to the normal and that of the half vector, of the
/// distribution of Estevez & Kulla 2017 ("Production Friendly Microfacet Sheen BRDF") with the visibility of Neubelt &
/// Pettineo 2013, as KHR_materials_sheen allows; white. `roughness` is perceptual, and at least what a float holds of
/// it.
double sheen_brdf(double n_dot_l, double n_dot_v, double n_dot_h, double roughness);

/// Its directional albedo, at most 1: over `steps` × 2 `steps` directions.
double sheen_albedo(double n_dot_v, double roughness, int steps);

/// One channel; columns are n·v from 0 to 1, rows roughness, both with their ends.
ImageF sheen_albedo_table(int size, int steps);

}  // namespace matchlight
