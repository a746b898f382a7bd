// Buffers, vertex arrays and textures over direct state access.
#include "gl/objects.h"

#include <bit>

namespace matchlight {

namespace {

bool is_integer_format(GLenum format) {
    switch (format) {
        case GL_R8UI:
        case GL_R16UI:
        case GL_R32UI:
        case GL_R32I:
        case GL_RG32UI:
        case GL_RGBA8UI:
        case GL_RGBA32UI:
            return true;
        default:
            return false;
    }
}

bool is_float_format(GLenum format) {
    switch (format) {
        case GL_R16F:
        case GL_RG16F:
        case GL_RGB16F:
        case GL_RGBA16F:
        case GL_R32F:
        case GL_RG32F:
        case GL_RGB32F:
        case GL_RGBA32F:
        case GL_R11F_G11F_B10F:
            return true;
        default:
            return false;
    }
}

bool is_depth_format(GLenum format) {
    return format == GL_DEPTH_COMPONENT32F || format == GL_DEPTH_COMPONENT24 || format == GL_DEPTH_COMPONENT16;
}

GLuint create_texture(GLenum target) {
    GLuint name = 0;
    glCreateTextures(target, 1, &name);
    return name;
}

GLenum target_of(const TextureShape& shape) {
    if (shape.samples > 0) return shape.layers > 0 ? GL_TEXTURE_2D_MULTISAMPLE_ARRAY : GL_TEXTURE_2D_MULTISAMPLE;
    return shape.layers > 0 ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D;
}

int full_chain(int width, int height) {
    return std::bit_width(static_cast<unsigned>(std::max(width, height)));
}

int channel_count(std::size_t samples, std::size_t pixels) {
    assert(pixels > 0 && samples % pixels == 0);
    const std::size_t channels = samples / pixels;
    assert(channels >= 1 && channels <= 4);
    return static_cast<int>(channels);
}

void set_filter_of(GLuint name, Filter filter) {
    GLint minify = GL_NEAREST;
    if (filter == Filter::linear) minify = GL_LINEAR;
    if (filter == Filter::trilinear) minify = GL_LINEAR_MIPMAP_LINEAR;
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, minify);
    glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, filter == Filter::nearest ? GL_NEAREST : GL_LINEAR);
}

}  // namespace

PixelTransfer pixel_transfer(GLenum internal_format, int channels, gl_detail::ClientType type) {
    assert(channels >= 1 && channels <= 4);
    PixelTransfer transfer;
    const bool integers = is_integer_format(internal_format);
    constexpr GLenum plain[] = {GL_RED, GL_RG, GL_RGB, GL_RGBA};
    constexpr GLenum integer[] = {GL_RED_INTEGER, GL_RG_INTEGER, GL_RGB_INTEGER, GL_RGBA_INTEGER};
    transfer.format = integers ? integer[channels - 1] : plain[channels - 1];
    if (is_depth_format(internal_format)) transfer.format = GL_DEPTH_COMPONENT;
    if (type.is_float) {
        assert(!integers);
        transfer.type = GL_FLOAT;
    } else if (type.bytes == 1) {
        transfer.type = type.is_signed ? GL_BYTE : GL_UNSIGNED_BYTE;
    } else if (type.bytes == 2) {
        transfer.type = GL_UNSIGNED_SHORT;
        if (type.is_signed) transfer.type = GL_SHORT;
        if (is_float_format(internal_format)) transfer.type = GL_HALF_FLOAT;
    } else {
        transfer.type = type.is_signed ? GL_INT : GL_UNSIGNED_INT;
    }
    return transfer;
}

Buffer::Buffer(std::size_t bytes) : bytes_(bytes) {
    assert(bytes > 0);
    GLuint name = 0;
    glCreateBuffers(1, &name);
    name_ = GlName<gl_detail::delete_buffer>(name);
    glNamedBufferStorage(name, static_cast<GLsizeiptr>(bytes), nullptr, GL_DYNAMIC_STORAGE_BIT);
}

BufferTexture::BufferTexture(const Buffer& buffer, GLenum format) {
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_BUFFER, 1, &name);
    name_ = GlName<gl_detail::delete_texture>(name);
    glTextureBuffer(name, format, buffer.name());
}

void Buffer::clear() const {
    glClearNamedBufferData(name(), GL_R8, GL_RED, GL_UNSIGNED_BYTE, nullptr);
}

void Buffer::upload_bytes(const void* data, std::size_t bytes, std::size_t offset) {
    assert(offset + bytes <= bytes_);
    glNamedBufferSubData(name(), static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes), data);
}

void Buffer::read_bytes(void* data, std::size_t bytes, std::size_t offset) const {
    assert(offset + bytes <= bytes_);
    glGetNamedBufferSubData(name(), static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes), data);
}

void Buffer::bind(GLenum target, GLuint index) const {
    assert(name_);
    glBindBufferBase(target, index, name());
}

VertexArray::VertexArray() {
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    name_ = GlName<gl_detail::delete_vertex_array>(name);
}

void VertexArray::set_vertex_buffer(GLuint binding, const Buffer& buffer, std::size_t stride_bytes,
                                    std::span<const Attribute> attributes, GLuint divisor) {
    const GLuint array = name_.get();
    glVertexArrayVertexBuffer(array, binding, buffer.name(), 0, static_cast<GLsizei>(stride_bytes));
    glVertexArrayBindingDivisor(array, binding, divisor);
    for (const Attribute& attribute : attributes) {
        assert(attribute.components >= 1 && attribute.components <= 4);
        const auto offset = static_cast<GLuint>(attribute.byte_offset);
        glEnableVertexArrayAttrib(array, attribute.location);
        if (attribute.is_integer) {
            glVertexArrayAttribIFormat(array, attribute.location, attribute.components, GL_UNSIGNED_INT, offset);
        } else {
            glVertexArrayAttribFormat(array, attribute.location, attribute.components, GL_FLOAT, GL_FALSE, offset);
        }
        glVertexArrayAttribBinding(array, attribute.location, binding);
    }
}

void VertexArray::set_index_buffer(const Buffer& buffer) {
    glVertexArrayElementBuffer(name_.get(), buffer.name());
}

Texture2D::Texture2D(const TextureShape& shape) : name_(create_texture(target_of(shape))), shape_(shape) {
    assert(shape.width > 0 && shape.height > 0 && shape.levels >= 0 && shape.layers >= 0 && shape.samples >= 0);
    if (shape_.levels == 0) shape_.levels = full_chain(shape.width, shape.height);
    if (shape.samples > 0) {
        assert(shape_.levels == 1);
        if (shape.layers > 0) {
            glTextureStorage3DMultisample(name(), shape.samples, shape.format, shape.width, shape.height, shape.layers,
                                          GL_TRUE);
        } else {
            glTextureStorage2DMultisample(name(), shape.samples, shape.format, shape.width, shape.height, GL_TRUE);
        }
        return;
    }
    if (shape.layers > 0) {
        glTextureStorage3D(name(), shape_.levels, shape.format, shape.width, shape.height, shape.layers);
    } else {
        glTextureStorage2D(name(), shape_.levels, shape.format, shape.width, shape.height);
    }
    set_filter(Filter::nearest);
    set_wrap(Wrap::clamp_to_edge, Wrap::clamp_to_edge);
}

void Texture2D::upload_samples(const Region& region, const void* data, std::size_t count, gl_detail::ClientType type,
                               int level, int layer) {
    assert(name_ && shape_.samples == 0 && level < shape_.levels);
    assert(layer == 0 || layer < shape_.layers);
    if (region.empty()) return;
    const std::size_t pixels = static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height);
    const PixelTransfer transfer = pixel_transfer(shape_.format, channel_count(count, pixels), type);
    if (shape_.layers > 0) {
        glTextureSubImage3D(name(), level, region.x, region.y, layer, region.width, region.height, 1, transfer.format,
                            transfer.type, data);
    } else {
        glTextureSubImage2D(name(), level, region.x, region.y, region.width, region.height, transfer.format,
                            transfer.type, data);
    }
}

void Texture2D::read_samples(const Region& region, void* data, std::size_t count, gl_detail::ClientType type, int level,
                             int layer) const {
    assert(name_ && shape_.samples == 0 && level < shape_.levels);
    if (region.empty()) return;
    const std::size_t pixels = static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height);
    const PixelTransfer transfer = pixel_transfer(shape_.format, channel_count(count, pixels), type);
    glGetTextureSubImage(name(), level, region.x, region.y, layer, region.width, region.height, 1, transfer.format,
                         transfer.type, static_cast<GLsizei>(count * type.bytes), data);
}

void Texture2D::clear(float r, float g, float b, float a) {
    assert(name_ && !is_integer_format(shape_.format));
    const float color[] = {r, g, b, a};
    glClearTexImage(name(), 0, is_depth_format(shape_.format) ? GL_DEPTH_COMPONENT : GL_RGBA, GL_FLOAT, color);
}

void Texture2D::make_mipmaps() {
    assert(name_ && shape_.samples == 0);
    glGenerateTextureMipmap(name());
}

void Texture2D::set_filter(Filter filter) {
    assert(name_ && shape_.samples == 0);
    set_filter_of(name(), filter);
}

void Texture2D::set_filter(const TextureFilter& filter) {
    assert(name_ && shape_.samples == 0);
    GLint far = filter.is_smooth_far ? GL_LINEAR : GL_NEAREST;
    if (filter.mipmaps == Mipmaps::nearest)
        far = filter.is_smooth_far ? GL_LINEAR_MIPMAP_NEAREST : GL_NEAREST_MIPMAP_NEAREST;
    if (filter.mipmaps == Mipmaps::linear)
        far = filter.is_smooth_far ? GL_LINEAR_MIPMAP_LINEAR : GL_NEAREST_MIPMAP_LINEAR;
    glTextureParameteri(name(), GL_TEXTURE_MIN_FILTER, far);
    glTextureParameteri(name(), GL_TEXTURE_MAG_FILTER, filter.is_smooth_near ? GL_LINEAR : GL_NEAREST);
    if (filter.anisotropy > 1 && epoxy_has_gl_extension("GL_EXT_texture_filter_anisotropic")) {
        GLfloat most = 1;
        glGetFloatv(GL_MAX_TEXTURE_MAX_ANISOTROPY_EXT, &most);
        glTextureParameterf(name(), GL_TEXTURE_MAX_ANISOTROPY_EXT, std::min(filter.anisotropy, most));
    }
}

void Texture2D::set_wrap(Wrap u, Wrap v) {
    assert(name_ && shape_.samples == 0);
    const auto mode = [](Wrap wrap) {
        if (wrap == Wrap::mirrored_repeat) return GL_MIRRORED_REPEAT;
        return wrap == Wrap::repeat ? GL_REPEAT : GL_CLAMP_TO_EDGE;
    };
    glTextureParameteri(name(), GL_TEXTURE_WRAP_S, mode(u));
    glTextureParameteri(name(), GL_TEXTURE_WRAP_T, mode(v));
}

void Texture2D::set_depth_comparison(bool on) {
    assert(is_depth_format(shape_.format));
    glTextureParameteri(name(), GL_TEXTURE_COMPARE_MODE, on ? GL_COMPARE_REF_TO_TEXTURE : GL_NONE);
    glTextureParameteri(name(), GL_TEXTURE_COMPARE_FUNC, GL_GEQUAL);
}

void Texture2D::bind_image(GLuint unit, GLenum access, int level) const {
    glBindImageTexture(unit, name(), level, shape_.layers > 0 ? GL_TRUE : GL_FALSE, 0, access, shape_.format);
}

TextureCube::TextureCube(GLenum format, int face_size, int levels)
    : name_(create_texture(GL_TEXTURE_CUBE_MAP)), format_(format), face_size_(face_size), levels_(levels) {
    assert(face_size > 0 && levels > 0 && (face_size >> (levels - 1)) > 0);
    glTextureStorage2D(name(), levels, format, face_size, face_size);
    set_filter(Filter::trilinear);
}

void TextureCube::upload_samples(int level, int face, const void* data, std::size_t count, gl_detail::ClientType type) {
    assert(name_ && level < levels_ && face >= 0 && face < 6);
    const int size = face_size(level);
    const auto pixels = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
    const PixelTransfer transfer = pixel_transfer(format_, channel_count(count, pixels), type);
    glTextureSubImage3D(name(), level, 0, 0, face, size, size, 1, transfer.format, transfer.type, data);
}

void TextureCube::read_samples(int level, int face, void* data, std::size_t count, gl_detail::ClientType type) const {
    assert(name_ && level < levels_ && face >= 0 && face < 6);
    const int size = face_size(level);
    const auto pixels = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
    const PixelTransfer transfer = pixel_transfer(format_, channel_count(count, pixels), type);
    glGetTextureSubImage(name(), level, 0, 0, face, size, size, 1, transfer.format, transfer.type,
                         static_cast<GLsizei>(count * type.bytes), data);
}

void TextureCube::set_filter(Filter filter) {
    set_filter_of(name(), filter);
}

void TextureCube::bind_image(GLuint unit, GLenum access, int level) const {
    glBindImageTexture(unit, name(), level, GL_TRUE, 0, access, format_);
}

}  // namespace matchlight
