// The gathered picture of the real surface as shaders/common/surface_picture.glsl reads it.
#pragma once

#include <memory>

#include "gl/objects.h"
#include "gl/program.h"
#include "render/gathered_surface.h"

namespace matchlight {

class SurfacePictureMap {
public:
    /// `gathered` may be null: then nothing is known anywhere.
    explicit SurfacePictureMap(const std::shared_ptr<const GatheredSurface>& gathered);

    bool present() const { return texel_m_ > 0; }
    /// Takes one texture unit and sets the uniforms of common/surface_picture.glsl.
    void bind(Program& program, GLuint unit) const;

private:
    Texture2D texels_;  // radiance · knowledge, knowledge; every mip level the mean of what it covers
    Eigen::AlignedBox2d rectangle_m_;
    double texel_m_ = 0;
};

}  // namespace matchlight
