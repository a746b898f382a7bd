// Draws finished pictures into a window, code value by code value, and whatever is drawn over them.
#pragma once

#include <Eigen/Core>

#include "core/image.h"
#include "gl/framebuffer.h"
#include "gl/shader_library.h"
#include "preview/letterbox.h"

namespace matchlight {

/// A picture on the GPU.
class ShownPicture {
public:
    /// R'G'B' of 8 bits whose pixels are `pixel_aspect` times as wide as high; false where it is the same as before.
    /// Throws InputError where it is larger than a texture can be.
    bool set(const Image8& picture, double pixel_aspect);

    explicit operator bool() const { return static_cast<bool>(texture_); }
    PictureSize displayed() const { return displayed_size(texture_.width(), texture_.height(), pixel_aspect_); }

private:
    friend class PictureView;
    Texture2D texture_;
    Image8 of_texture_;
    double pixel_aspect_ = 1;
    bool has_mipmaps_ = false;
};

class PictureView {
public:
    /// Of the window's size: whether what was drawn before is gone.
    bool begin(int width, int height);
    /// All that is drawn from here is cut to this part of the window, which is black.
    void begin_part(const Region& part);
    /// The picture with its left, top, width and height in the window, cut to `clip`; black where `clip` is larger.
    /// Where it is drawn at its size, or a whole multiple of it, samples are shown as they are.
    void draw(ShownPicture& picture, const Eigen::Vector4f& place, const Region& clip);
    /// Copies what was drawn into the window's own framebuffer.
    void present() const;
    /// What was drawn, 3 channels.
    Image8 shown() const;

    const Framebuffer& target() const { return target_; }

private:
    ShaderLibrary shaders_;
    FullScreenTriangle triangle_;
    Texture2D target_texture_;
    Framebuffer target_;
    Region part_;
};

}  // namespace matchlight
