// The weighted mean of several pictures of the virtual layer: from many points of the lens, at many times.
#pragma once

#include "gl/framebuffer.h"
#include "gl/program.h"
#include "gl/shader_library.h"
#include "render/surface.h"

namespace matchlight {

/// After Haeberli & Akeley 1990, "The Accumulation Buffer: Hardware Support for High-Quality Rendering".
class SurfaceAccumulator {
public:
    explicit SurfaceAccumulator(ShaderLibrary& shaders) : shaders_(shaders) {}

    /// Forgets what was added before.
    void begin(int width, int height);
    /// Adds weight · the picture's colour; the picture is of the size given to begin().
    void add(const SurfacePicture& picture, double weight);
    /// Colour alone, in full float; holds until the next begin().
    SurfacePicture picture() const;

private:
    ShaderLibrary& shaders_;
    FullScreenTriangle triangle_;
    int width_ = 0, height_ = 0;
    Texture2D sum_;
    Framebuffer target_;
};

}  // namespace matchlight
