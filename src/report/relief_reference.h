// What a relief stands for: the surface in small triangles, each corner moved to where the map says.
#pragma once

#include "core/image.h"
#include "scene/model.h"
#include "scene/surface_detail.h"

namespace matchlight {

/// Of a picture of heights on a model: `depth` in the model's units, from 1 down to 0.
struct CarvedHeights {
    const ImageF& heights;
    PictureWrap wrap = PictureWrap::repeat;
    double depth = 0;
};

/// The model cut into triangles about as fine as the map's texels, its corners moved inwards along their normals, in
/// double precision; normals are those of the triangles. Throws std::length_error above 16 million corners.
Model displaced_model(const Model& model, const CarvedHeights& carved);

}  // namespace matchlight
