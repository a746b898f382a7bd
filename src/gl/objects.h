// Owning, move-only OpenGL objects over direct state access; each is made and used with a context current.
//
// Programmer errors (wrong sizes, an empty object) are asserted. Regions count from the top-left pixel, row 0 first in
// memory, as everywhere (context.h).
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include <epoxy/gl.h>

#include "core/image.h"

namespace matchlight {

/// A GL name that deletes itself. `Delete` takes the name.
template <void (*Delete)(GLuint)>
class GlName {
public:
    GlName() = default;
    explicit GlName(GLuint name) : name_(name) {}
    GlName(GlName&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    GlName& operator=(GlName&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    ~GlName() {
        if (name_ != 0) Delete(name_);
    }
    GLuint get() const { return name_; }
    explicit operator bool() const { return name_ != 0; }

private:
    GLuint name_ = 0;
};

namespace gl_detail {
inline void delete_buffer(GLuint name) {
    glDeleteBuffers(1, &name);
}
inline void delete_vertex_array(GLuint name) {
    glDeleteVertexArrays(1, &name);
}
inline void delete_texture(GLuint name) {
    glDeleteTextures(1, &name);
}
inline void delete_framebuffer(GLuint name) {
    glDeleteFramebuffers(1, &name);
}
inline void delete_query(GLuint name) {
    glDeleteQueries(1, &name);
}

/// The client-side type of samples: float, std::uint8_t, std::uint16_t (16-bit integers, or half floats where the
/// texture holds floats), std::uint32_t and std::int32_t for integer textures.
struct ClientType {
    std::size_t bytes = 0;
    bool is_float = false;
    bool is_signed = false;
};
template <class Sample>
constexpr ClientType client_type() {
    static_assert(std::is_arithmetic_v<Sample> && sizeof(Sample) <= 4);
    return {sizeof(Sample), std::is_floating_point_v<Sample>, std::is_signed_v<Sample>};
}
}  // namespace gl_detail

/// A block of GPU memory with a fixed size.
class Buffer {
public:
    Buffer() = default;
    /// Storage that the CPU may update with `upload`.
    explicit Buffer(std::size_t bytes);
    template <class Element>
    explicit Buffer(std::span<const Element> elements) : Buffer(elements.size_bytes()) {
        upload(elements);
    }

    template <class Element>
    void upload(std::span<const Element> elements, std::size_t byte_offset = 0) {
        static_assert(std::is_trivially_copyable_v<Element>);
        upload_bytes(elements.data(), elements.size_bytes(), byte_offset);
    }
    template <class Element>
    void read(std::span<Element> elements, std::size_t byte_offset = 0) const {
        static_assert(std::is_trivially_copyable_v<Element>);
        read_bytes(elements.data(), elements.size_bytes(), byte_offset);
    }
    /// Sets every byte to 0.
    void clear() const;
    /// To an indexed binding point: GL_SHADER_STORAGE_BUFFER, GL_UNIFORM_BUFFER, …
    void bind(GLenum target, GLuint index) const;

    std::size_t bytes() const { return bytes_; }
    GLuint name() const { return name_.get(); }

private:
    void upload_bytes(const void* data, std::size_t bytes, std::size_t offset);
    void read_bytes(void* data, std::size_t bytes, std::size_t offset) const;

    GlName<gl_detail::delete_buffer> name_;
    std::size_t bytes_ = 0;
};

/// A buffer as shaders fetch texels of it: usamplerBuffer or samplerBuffer, by the format. On software rasterisers
/// fetches are much quicker than reads of shader storage. The buffer must outlive it.
class BufferTexture {
public:
    BufferTexture() = default;
    BufferTexture(const Buffer& buffer, GLenum format);

    void bind(GLuint unit) const { glBindTextureUnit(unit, name_.get()); }

private:
    GlName<gl_detail::delete_texture> name_;
};

/// How vertices are read from buffers. Buffers must outlive their use here.
class VertexArray {
public:
    VertexArray();

    struct Attribute {
        GLuint location = 0;
        int components = 4;
        std::size_t byte_offset = 0;  // within one element
        bool is_integer = false;      // 32-bit unsigned instead of float
    };
    /// Attributes of one interleaved buffer; `divisor` 1 steps once an instance instead of once a vertex.
    void set_vertex_buffer(GLuint binding, const Buffer& buffer, std::size_t stride_bytes,
                           std::span<const Attribute> attributes, GLuint divisor = 0);
    void set_index_buffer(const Buffer& buffer);  // 32-bit indices

    void bind() const { glBindVertexArray(name_.get()); }

private:
    GlName<gl_detail::delete_vertex_array> name_;
};

enum class Filter { nearest, linear, trilinear };
enum class Wrap { clamp_to_edge, repeat, mirrored_repeat };
enum class Mipmaps { none, nearest, linear };

/// What Filter does not name.
struct TextureFilter {
    Mipmaps mipmaps = Mipmaps::linear;
    bool is_smooth_near = true, is_smooth_far = true;  // between texels, where they are magnified and minified
    float anisotropy =
        1;  // how much longer than wide a pixel may lie on the texture; ignored where the driver has none
};

/// Size and format of a two-dimensional texture.
struct TextureShape {
    GLenum format = GL_RGBA32F;  // sized internal format
    int width = 1;
    int height = 1;
    int levels = 1;   // mip levels; 0 makes the full chain
    int layers = 0;   // > 0 makes an array
    int samples = 0;  // > 0 makes it multisampled: one level, no upload, no readback
};

/// A two-dimensional texture, array or multisampled texture with immutable storage; nearest and clamped at first.
class Texture2D {
public:
    Texture2D() = default;
    explicit Texture2D(const TextureShape& shape);

    /// Fills `region` of a level (and array layer); the channel count follows from the size of `samples`.
    template <class Sample>
    void upload(const Region& region, std::span<const Sample> samples, int level = 0, int layer = 0) {
        upload_samples(region, samples.data(), samples.size(), gl_detail::client_type<Sample>(), level, layer);
    }
    /// A whole image into level 0.
    template <class Sample>
    void upload(const Image<Sample>& image) {
        upload(image.bounds(), image.samples());
    }
    /// Reads `region` of a level; the channel count follows from the size of `samples`.
    template <class Sample>
    void read(const Region& region, std::span<Sample> samples, int level = 0, int layer = 0) const {
        read_samples(region, samples.data(), samples.size(), gl_detail::client_type<Sample>(), level, layer);
    }
    template <class Sample>
    Image<Sample> read(const Region& region, int channels, int level = 0, int layer = 0) const {
        Image<Sample> image(region.width, region.height, channels);
        read(region, image.samples(), level, layer);
        return image;
    }
    /// Sets every sample of level 0 to one colour (float formats).
    void clear(float r, float g, float b, float a);
    void make_mipmaps();
    void set_filter(Filter filter);
    void set_filter(const TextureFilter& filter);
    void set_wrap(Wrap u, Wrap v);
    /// For sampler2DShadow: fetches return the share of taps for which reference ≥ (reversed z) the stored depth.
    void set_depth_comparison(bool on);

    void bind(GLuint unit) const { glBindTextureUnit(unit, name()); }
    void bind_image(GLuint unit, GLenum access, int level = 0) const;

    const TextureShape& shape() const { return shape_; }
    int width() const { return shape_.width; }
    int height() const { return shape_.height; }
    Region bounds() const { return {0, 0, shape_.width, shape_.height}; }
    GLuint name() const { return name_.get(); }
    explicit operator bool() const { return static_cast<bool>(name_); }

private:
    void upload_samples(const Region& region, const void* data, std::size_t count, gl_detail::ClientType type,
                        int level, int layer);
    void read_samples(const Region& region, void* data, std::size_t count, gl_detail::ClientType type, int level,
                      int layer) const;

    GlName<gl_detail::delete_texture> name_;
    TextureShape shape_;
};

/// A cube map with immutable storage; trilinear. Faces in GL's order +x −x +y −y +z −z.
class TextureCube {
public:
    TextureCube() = default;
    TextureCube(GLenum format, int face_size, int levels);

    template <class Sample>
    void upload(int level, int face, std::span<const Sample> samples) {
        upload_samples(level, face, samples.data(), samples.size(), gl_detail::client_type<Sample>());
    }
    template <class Sample>
    void read(int level, int face, std::span<Sample> samples) const {
        read_samples(level, face, samples.data(), samples.size(), gl_detail::client_type<Sample>());
    }
    void set_filter(Filter filter);
    void make_mipmaps() { glGenerateTextureMipmap(name()); }
    void bind(GLuint unit) const { glBindTextureUnit(unit, name()); }
    void bind_image(GLuint unit, GLenum access, int level) const;

    int face_size(int level = 0) const { return face_size_ >> level; }
    int levels() const { return levels_; }
    GLenum format() const { return format_; }
    GLuint name() const { return name_.get(); }
    explicit operator bool() const { return static_cast<bool>(name_); }

private:
    void upload_samples(int level, int face, const void* data, std::size_t count, gl_detail::ClientType type);
    void read_samples(int level, int face, void* data, std::size_t count, gl_detail::ClientType type) const;

    GlName<gl_detail::delete_texture> name_;
    GLenum format_ = GL_RGBA16F;
    int face_size_ = 0;
    int levels_ = 0;
};

/// Draws one triangle that covers the viewport; goes with shaders/common/fullscreen.vert.
class FullScreenTriangle {
public:
    void draw() const {
        vertices_.bind();
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }
    /// As often as the bound GL_DRAW_INDIRECT_BUFFER says.
    void draw_indirect() const {
        vertices_.bind();
        glDrawArraysIndirect(GL_TRIANGLES, nullptr);
    }

    /// Instead of the triangle: strips of four vertices each, placed by a vertex shader of its own.
    void draw_quads(int count) const {
        vertices_.bind();
        glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count);
    }

private:
    VertexArray vertices_;  // the core profile wants one even without attributes
};

/// GL_RED … GL_RGBA (or their _INTEGER forms) and the type, as glTexSubImage wants them.
struct PixelTransfer {
    GLenum format = GL_RGBA;
    GLenum type = GL_FLOAT;
};
PixelTransfer pixel_transfer(GLenum internal_format, int channels, gl_detail::ClientType type);

}  // namespace matchlight
