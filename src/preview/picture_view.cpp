// One texture a picture, one triangle; filtered only where the picture has another size than its place.
#include "preview/picture_view.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"
#include "gl/context.h"

namespace matchlight {

bool ShownPicture::set(const Image8& picture, double pixel_aspect) {
    const bool same = texture_ && pixel_aspect == pixel_aspect_ && picture.width() == of_texture_.width() &&
                      picture.height() == of_texture_.height() &&
                      std::ranges::equal(picture.samples(), of_texture_.samples());
    if (same) return false;
    const int limit = current_gl_context()->info().max_texture_size;
    if (std::max(picture.width(), picture.height()) > limit) {
        throw InputError({}, fmt::format("a picture of {}×{} pixels cannot be shown: textures here end at {}",
                                         picture.width(), picture.height(), limit));
    }
    if (!texture_ || texture_.width() != picture.width() || texture_.height() != picture.height()) {
        texture_ = Texture2D({.format = GL_RGBA8, .width = picture.width(), .height = picture.height(), .levels = 0});
    }
    texture_.upload(picture);
    of_texture_ = picture;
    pixel_aspect_ = pixel_aspect;
    has_mipmaps_ = false;
    return true;
}

bool PictureView::begin(int width, int height) {
    if (target_ && target_.width() == width && target_.height() == height) return false;
    target_texture_ = Texture2D({.format = GL_RGBA8, .width = width, .height = height});
    target_ = Framebuffer({target_texture_});
    return true;
}

void PictureView::begin_part(const Region& part) {
    part_ = part.intersected(target_.bounds());
    glEnable(GL_SCISSOR_TEST);
    glScissor(part_.x, part_.y, part_.width, part_.height);
    target_.clear_color(0, 0, 0, 0, 1);
    glDisable(GL_SCISSOR_TEST);
}

void PictureView::draw(ShownPicture& picture, const Eigen::Vector4f& place, const Region& clip) {
    const Region seen = clip.intersected(part_);
    if (seen.empty()) return;
    Texture2D& texture = picture.texture_;
    // Whole factors show every sample as it is.
    const float factor = place[3] / static_cast<float>(texture.height());
    const bool whole = std::floor(factor) == factor && place[2] == factor * static_cast<float>(texture.width());
    if (factor < 1 && !picture.has_mipmaps_) {
        texture.make_mipmaps();
        picture.has_mipmaps_ = true;
    }
    texture.set_filter(whole ? Filter::nearest : factor < 1 ? Filter::trilinear : Filter::linear);
    Program& program = shaders_.full_screen("preview/picture.frag");
    target_.bind(seen);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    program.use();
    program.set("place", place);
    program.bind_texture("picture", 0, texture);
    triangle_.draw();
    check_no_gl_error("drawing the picture");
}

void PictureView::present() const {
    // Mesa's software rasteriser asks a window for its new size when a viewport is set on it.
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, target_.width(), target_.height());
    // Row 0 is the top here and the bottom of a window.
    glBlitNamedFramebuffer(target_.name(), 0, 0, 0, target_.width(), target_.height(), 0, target_.height(),
                           target_.width(), 0, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    check_no_gl_error("showing the picture");
}

Image8 PictureView::shown() const {
    return target_.read<std::uint8_t>(target_.bounds(), 3);
}

}  // namespace matchlight
