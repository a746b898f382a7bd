// Framebuffers: what a pass draws into, how it is cleared, resolved and read back.
#pragma once

#include <initializer_list>
#include <span>

#include "gl/objects.h"

namespace matchlight {

/// One attachment: a level and (for arrays and cube faces) a layer of a texture that outlives the framebuffer.
struct Attachment {
    GLuint texture = 0;
    GLenum format = GL_NONE;
    int width = 0, height = 0;
    int level = 0;
    int layer = -1;  // −1: the whole texture

    Attachment() = default;
    Attachment(const Texture2D& of, int at_level = 0, int at_layer = -1)  // NOLINT(google-explicit-constructor)
        : texture(of.name()),
          format(of.shape().format),
          width(of.width() >> at_level),
          height(of.height() >> at_level),
          level(at_level),
          layer(at_layer) {}
    /// One face of one level of a cube map.
    Attachment(const TextureCube& of, int at_level, int face)
        : texture(of.name()),
          format(of.format()),
          width(of.face_size(at_level)),
          height(of.face_size(at_level)),
          level(at_level),
          layer(face) {}
};

class Framebuffer {
public:
    Framebuffer() = default;
    /// Colour attachments in the order of the fragment shader's output locations; `depth` may be empty. Throws
    /// InputError when the driver does not take the combination.
    explicit Framebuffer(std::initializer_list<Attachment> colors, const Attachment& depth = {});
    explicit Framebuffer(std::span<const Attachment> colors, const Attachment& depth = {});

    /// Draws go here, to the whole of it.
    void bind() const;
    /// … or to a part of it only (viewport and scissor stay the caller's to reset by the next bind()).
    void bind(const Region& viewport) const;

    void clear_color(int attachment, float r, float g, float b, float a) const;
    void clear_color_integer(int attachment, std::uint32_t value) const;
    /// Reversed z: 0 is the far plane at infinity.
    void clear_depth(float depth = 0) const;

    /// Averages the samples of a colour attachment into one of `target`; the same region of both.
    void resolve_color_to(const Framebuffer& target, const Region& region, int attachment = 0,
                          int target_attachment = 0) const;

    /// Of several samples' depths the driver takes one; the same region of both, of one format.
    void resolve_depth_to(const Framebuffer& target, const Region& region) const;

    /// Reads a region of a colour attachment; the channel count follows from the size of `samples`.
    template <class Sample>
    void read(const Region& region, std::span<Sample> samples, int attachment = 0) const {
        read_samples(region, samples.data(), samples.size(), gl_detail::client_type<Sample>(), attachment);
    }
    template <class Sample>
    Image<Sample> read(const Region& region, int channels, int attachment = 0) const {
        Image<Sample> image(region.width, region.height, channels);
        read(region, image.samples(), attachment);
        return image;
    }

    int width() const { return width_; }
    int height() const { return height_; }
    Region bounds() const { return {0, 0, width_, height_}; }
    GLuint name() const { return name_.get(); }
    explicit operator bool() const { return static_cast<bool>(name_); }

private:
    void attach(GLenum point, const Attachment& attachment);
    void read_samples(const Region& region, void* data, std::size_t count, gl_detail::ClientType type,
                      int attachment) const;

    GlName<gl_detail::delete_framebuffer> name_;
    std::vector<GLenum> color_formats_;
    int width_ = 0;
    int height_ = 0;
};

}  // namespace matchlight
