// Linked shader programs and their uniforms, set by name.
#pragma once

#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "gl/objects.h"

namespace matchlight {

namespace gl_detail {
inline void delete_program(GLuint name) {
    glDeleteProgram(name);
}
inline void delete_shader(GLuint name) {
    glDeleteShader(name);
}
}  // namespace gl_detail

using ShaderName = GlName<gl_detail::delete_shader>;

/// A linked program. Setting a uniform that the compiler removed, or that a variant does not have, does nothing.
class Program {
public:
    /// Links compiled shaders. Throws InputError with `label` and the driver's log.
    Program(std::span<const ShaderName> shaders, std::string label);

    void use() const { glUseProgram(name_.get()); }

    void set(const std::string& uniform, int value);
    void set(const std::string& uniform, unsigned value);
    void set(const std::string& uniform, bool value) { set(uniform, value ? 1 : 0); }
    void set(const std::string& uniform, float value);
    void set(const std::string& uniform, double value) { set(uniform, static_cast<float>(value)); }
    void set(const std::string& uniform, const Eigen::Vector2i& value);
    void set(const std::string& uniform, const Eigen::Vector4i& value);
    void set(const std::string& uniform, const Eigen::Vector2f& value);
    void set(const std::string& uniform, const Eigen::Vector3f& value);
    void set(const std::string& uniform, const Eigen::Vector4f& value);
    void set(const std::string& uniform, const Eigen::Matrix3f& value);
    void set(const std::string& uniform, const Eigen::Matrix4f& value);
    // Arrays, named without "[0]".
    void set(const std::string& uniform, std::span<const float> values);
    void set(const std::string& uniform, std::span<const Eigen::Vector3f> values);
    void set(const std::string& uniform, std::span<const Eigen::Vector4f> values);
    void set(const std::string& uniform, std::span<const Eigen::Matrix4f> values);

    /// Binds the texture to the unit and points the sampler there.
    template <class Texture>
    void bind_texture(const std::string& sampler, GLuint unit, const Texture& texture) {
        texture.bind(unit);
        set(sampler, static_cast<int>(unit));
    }

    bool has_uniform(const std::string& uniform) { return location(uniform) >= 0; }
    const std::string& label() const { return label_; }
    GLuint name() const { return name_.get(); }

private:
    GLint location(const std::string& uniform);

    GlName<gl_detail::delete_program> name_;
    std::string label_;
    std::unordered_map<std::string, GLint> locations_;
};

}  // namespace matchlight
