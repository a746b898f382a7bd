// Draws a finished picture into a window, code value by code value.
#pragma once

#include <Eigen/Core>

#include "core/image.h"
#include "gl/framebuffer.h"
#include "gl/shader_library.h"
#include "preview/letterbox.h"

namespace matchlight {

class PictureView {
public:
    /// R'G'B' of 8 bits whose pixels are `pixel_aspect` times as wide as high. Throws InputError where it is larger
    /// than a texture can be.
    void set_picture(const Image8& picture, double pixel_aspect);

    /// Draws what a window of this size shows. Where the picture has its size, that is the picture itself.
    void draw(int width, int height);
    /// Copies what was drawn into the window's own framebuffer.
    void present() const;
    /// What was drawn, 3 channels.
    Image8 shown() const;

private:
    ShaderLibrary shaders_;
    FullScreenTriangle triangle_;
    Texture2D picture_;
    double pixel_aspect_ = 1;
    bool has_mipmaps_ = false;
    Texture2D target_texture_;
    Framebuffer target_;
};

}  // namespace matchlight
