// Framebuffers over direct state access.
#include "gl/framebuffer.h"

#include <fmt/format.h>

#include "core/error.h"

namespace matchlight {

Framebuffer::Framebuffer(std::initializer_list<Attachment> colors, const Attachment& depth)
    : Framebuffer(std::span(colors.begin(), colors.size()), depth) {}

Framebuffer::Framebuffer(std::span<const Attachment> colors, const Attachment& depth) {
    GLuint name = 0;
    glCreateFramebuffers(1, &name);
    name_ = GlName<gl_detail::delete_framebuffer>(name);
    std::vector<GLenum> draw_buffers;
    for (const Attachment& color : colors) {
        const GLenum point = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(draw_buffers.size());
        attach(point, color);
        draw_buffers.push_back(point);
        color_formats_.push_back(color.format);
    }
    if (depth.texture != 0) attach(GL_DEPTH_ATTACHMENT, depth);
    assert(width_ > 0 && height_ > 0);
    if (draw_buffers.empty()) {
        glNamedFramebufferDrawBuffer(name, GL_NONE);
        glNamedFramebufferReadBuffer(name, GL_NONE);
    } else {
        glNamedFramebufferDrawBuffers(name, static_cast<GLsizei>(draw_buffers.size()), draw_buffers.data());
    }
    const GLenum status = glCheckNamedFramebufferStatus(name, GL_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE) {
        throw InputError({}, fmt::format("OpenGL does not take a framebuffer of {}×{} pixels (status {:#x})", width_,
                                         height_, status));
    }
}

void Framebuffer::attach(GLenum point, const Attachment& attachment) {
    assert(attachment.texture != 0 && attachment.width > 0 && attachment.height > 0);
    assert(width_ == 0 || (width_ == attachment.width && height_ == attachment.height));
    width_ = attachment.width;
    height_ = attachment.height;
    if (attachment.layer >= 0) {
        glNamedFramebufferTextureLayer(name(), point, attachment.texture, attachment.level, attachment.layer);
    } else {
        glNamedFramebufferTexture(name(), point, attachment.texture, attachment.level);
    }
}

void Framebuffer::bind() const {
    bind(bounds());
}

void Framebuffer::bind(const Region& viewport) const {
    assert(name_);
    glBindFramebuffer(GL_FRAMEBUFFER, name());
    glViewport(viewport.x, viewport.y, viewport.width, viewport.height);
}

void Framebuffer::clear_color(int attachment, float r, float g, float b, float a) const {
    const float color[] = {r, g, b, a};
    glClearNamedFramebufferfv(name(), GL_COLOR, attachment, color);
}

void Framebuffer::clear_color_integer(int attachment, std::uint32_t value) const {
    const GLuint color[] = {value, value, value, value};
    glClearNamedFramebufferuiv(name(), GL_COLOR, attachment, color);
}

void Framebuffer::clear_depth(float depth) const {
    glDepthMask(GL_TRUE);  // a clear obeys the mask
    glClearNamedFramebufferfv(name(), GL_DEPTH, 0, &depth);
}

void Framebuffer::resolve_color_to(const Framebuffer& target, const Region& region, int attachment,
                                   int target_attachment) const {
    glNamedFramebufferReadBuffer(name(), GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(attachment));
    const GLenum to = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(target_attachment);
    glNamedFramebufferDrawBuffers(target.name(), 1, &to);
    const int right = region.x + region.width;
    const int bottom = region.y + region.height;
    glBlitNamedFramebuffer(name(), target.name(), region.x, region.y, right, bottom, region.x, region.y, right, bottom,
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
    std::vector<GLenum> all;
    for (std::size_t i = 0; i < target.color_formats_.size(); ++i) {
        all.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i));
    }
    glNamedFramebufferDrawBuffers(target.name(), static_cast<GLsizei>(all.size()), all.data());
}

void Framebuffer::resolve_depth_to(const Framebuffer& target, const Region& region) const {
    const int right = region.x + region.width;
    const int bottom = region.y + region.height;
    glBlitNamedFramebuffer(name(), target.name(), region.x, region.y, right, bottom, region.x, region.y, right, bottom,
                           GL_DEPTH_BUFFER_BIT, GL_NEAREST);
}

void Framebuffer::read_samples(const Region& region, void* data, std::size_t count, gl_detail::ClientType type,
                               int attachment) const {
    assert(static_cast<std::size_t>(attachment) < color_formats_.size());
    assert(region == region.intersected(bounds()));
    if (region.empty()) return;
    const std::size_t pixels = static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height);
    assert(count % pixels == 0);
    const auto channels = static_cast<int>(count / pixels);
    const PixelTransfer transfer = pixel_transfer(color_formats_[static_cast<std::size_t>(attachment)], channels, type);
    glNamedFramebufferReadBuffer(name(), GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(attachment));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, name());
    glReadPixels(region.x, region.y, region.width, region.height, transfer.format, transfer.type, data);
}

}  // namespace matchlight
