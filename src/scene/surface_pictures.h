// The pictures that the scene lays on an object: read, and the model made ready for them.
#pragma once

#include <vector>

#include "core/image.h"
#include "core/warnings.h"
#include "scene/model.h"
#include "scene/scene_file.h"
#include "scene/surface_detail.h"

namespace matchlight {

/// What the settings of SurfaceDetail ask for, decoded.
struct SurfacePictures {
    SurfaceDetail settings;
    PictureWrap relief_wrap = PictureWrap::repeat;
    ImageF heights;                     // empty: no relief
    double u_extent = 1, v_extent = 1;  // of the height map on the surface, in the model's units: their mean
    std::vector<Image8> layers;         // RGBA, sRGB, all of one size
};

/// Puts normal map, sampling and scale of the texture coordinates on the model, reads the rest. Throws InputError
/// naming the picture that cannot be read; a model without texture coordinates that would need some is counted as a
/// warning, and keeps its flat surface.
SurfacePictures load_surface_pictures(Model& model, const MaterialOverride& material, Warnings& warnings);

}  // namespace matchlight
