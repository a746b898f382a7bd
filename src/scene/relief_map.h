// A picture of heights made ready to be searched along a ray: its slopes, its cones, its distances.
#pragma once

#include <filesystem>
#include <vector>

#include "core/image.h"
#include "core/warnings.h"
#include "scene/surface_detail.h"

namespace matchlight {

/// Heights from 0, the deepest, to 1, the surface: one channel.
/// Throws InputError: missing, unreadable, more than 16384 pixels a side. EXR and Radiance files are cut to 0..1, which
/// is counted as a warning; of colours the red one counts.
ImageF read_heights(const std::filesystem::path& picture, Warnings& warnings);

/// Rise from one end of the picture to the other at the slope of each texel, along u and along v (v grows downwards):
/// central differences, two channels.
ImageF slopes_of(const ImageF& heights, PictureWrap wrap);

/// For each texel how wide a cone may open above its height, in uv a unit of height, that meets no other texel that is
/// higher (Dummer 2006, "Cone Step Mapping: An Iterative Ray-Heightfield Intersection Algorithm"); at most 1. Of more
/// than a million texels the cones of blocks of them count.
ImageF cones_of(const ImageF& heights, PictureWrap wrap);

/// The distance from points above the heights to the nearest one below them, in depths of the relief, in layers from
/// the surface down to the deepest (Donnelly 2005, "Per-Pixel Displacement Mapping with Distance Functions", GPU Gems
/// 2, chapter 8; by the transform of Felzenszwalb & Huttenlocher 2012, "Distance Transforms of Sampled Functions").
/// `u_extent` and `v_extent`: of the picture on the surface, in depths. Never more than there is.
std::vector<ImageF> distances_above(const ImageF& heights, PictureWrap wrap, double u_extent, double v_extent);

/// Between texels, at coordinates that count whole pictures: as textures are read.
double height_at(const ImageF& heights, PictureWrap wrap, double u, double v);

/// The texel that stands for one outside of the picture.
int wrapped(int texel, int size, PictureWrap wrap);

}  // namespace matchlight
