// Links programs and sets uniforms by name through a cache of their locations.
#include "gl/program.h"

#include "core/error.h"

namespace matchlight {

Program::Program(std::span<const ShaderName> shaders, std::string label)
    : name_(glCreateProgram()), label_(std::move(label)) {
    for (const ShaderName& shader : shaders) glAttachShader(name(), shader.get());
    glLinkProgram(name());
    for (const ShaderName& shader : shaders) glDetachShader(name(), shader.get());
    GLint linked = GL_FALSE;
    glGetProgramiv(name(), GL_LINK_STATUS, &linked);
    if (linked == GL_TRUE) return;
    GLint length = 0;
    glGetProgramiv(name(), GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
    glGetProgramInfoLog(name(), length, &length, log.data());
    log.resize(static_cast<std::size_t>(std::max(length, 0)));
    throw InputError(label_, "the shaders do not link: " + log);
}

GLint Program::location(const std::string& uniform) {
    const auto known = locations_.find(uniform);
    if (known != locations_.end()) return known->second;
    const GLint found = glGetUniformLocation(name(), uniform.c_str());
    locations_.emplace(uniform, found);
    return found;
}

void Program::set(const std::string& uniform, int value) {
    glProgramUniform1i(name(), location(uniform), value);
}

void Program::set(const std::string& uniform, unsigned value) {
    glProgramUniform1ui(name(), location(uniform), value);
}

void Program::set(const std::string& uniform, float value) {
    glProgramUniform1f(name(), location(uniform), value);
}

void Program::set(const std::string& uniform, const Eigen::Vector2i& value) {
    glProgramUniform2i(name(), location(uniform), value.x(), value.y());
}

void Program::set(const std::string& uniform, const Eigen::Vector4i& value) {
    glProgramUniform4i(name(), location(uniform), value.x(), value.y(), value.z(), value.w());
}

void Program::set(const std::string& uniform, const Eigen::Vector2f& value) {
    glProgramUniform2fv(name(), location(uniform), 1, value.data());
}

void Program::set(const std::string& uniform, const Eigen::Vector3f& value) {
    glProgramUniform3fv(name(), location(uniform), 1, value.data());
}

void Program::set(const std::string& uniform, const Eigen::Vector4f& value) {
    glProgramUniform4fv(name(), location(uniform), 1, value.data());
}

void Program::set(const std::string& uniform, const Eigen::Matrix3f& value) {
    glProgramUniformMatrix3fv(name(), location(uniform), 1, GL_FALSE, value.data());
}

void Program::set(const std::string& uniform, const Eigen::Matrix4f& value) {
    glProgramUniformMatrix4fv(name(), location(uniform), 1, GL_FALSE, value.data());
}

void Program::set(const std::string& uniform, std::span<const float> values) {
    glProgramUniform1fv(name(), location(uniform), static_cast<GLsizei>(values.size()), values.data());
}

void Program::set(const std::string& uniform, std::span<const Eigen::Vector3f> values) {
    if (values.empty()) return;
    glProgramUniform3fv(name(), location(uniform), static_cast<GLsizei>(values.size()), values.front().data());
}

void Program::set(const std::string& uniform, std::span<const Eigen::Vector4f> values) {
    if (values.empty()) return;
    glProgramUniform4fv(name(), location(uniform), static_cast<GLsizei>(values.size()), values.front().data());
}

void Program::set(const std::string& uniform, std::span<const Eigen::Matrix4f> values) {
    if (values.empty()) return;
    glProgramUniformMatrix4fv(name(), location(uniform), static_cast<GLsizei>(values.size()), GL_FALSE,
                              values.front().data());
}

}  // namespace matchlight
