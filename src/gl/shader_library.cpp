// Finds the shader folder, compiles stages, keeps linked programs.
#include "gl/shader_library.h"

#include <cstdlib>

#include "core/error.h"

namespace matchlight {

namespace fs = std::filesystem;

fs::path shader_root() {
    if (const char* chosen = std::getenv("MATCHLIGHT_SHADERS"); chosen && *chosen) {
        if (!fs::is_directory(chosen)) throw InputError(chosen, "MATCHLIGHT_SHADERS names no folder");
        return chosen;
    }
    std::error_code error;
    const fs::path executable = fs::read_symlink("/proc/self/exe", error);
    const fs::path installed = executable.parent_path().parent_path() / "share/matchlight/shaders";
    if (!error && fs::is_directory(installed, error)) return installed;
    const fs::path source = MATCHLIGHT_SOURCE_SHADERS;
    if (fs::is_directory(source, error)) return source;
    throw InputError(installed, "the shader folder is missing", "install again or set MATCHLIGHT_SHADERS");
}

ShaderName compile_shader(const fs::path& root, const ShaderStage& stage, const ShaderDefines& defines) {
    const ShaderSource source = assemble_shader(root, stage.file, defines);
    ShaderName shader(glCreateShader(stage.stage));
    const char* text = source.text.c_str();
    glShaderSource(shader.get(), 1, &text, nullptr);
    glCompileShader(shader.get());
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader.get(), GL_COMPILE_STATUS, &compiled);
    if (compiled == GL_TRUE) return shader;
    GLint length = 0;
    glGetShaderiv(shader.get(), GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
    glGetShaderInfoLog(shader.get(), length, &length, log.data());
    log.resize(static_cast<std::size_t>(std::max(length, 0)));
    throw InputError(root / stage.file, "does not compile: " + with_file_names(log, source.files));
}

ShaderLibrary::ShaderLibrary(fs::path root) : root_(std::move(root)) {}

Program& ShaderLibrary::program(const std::vector<ShaderStage>& stages, const ShaderDefines& defines) {
    std::string key;
    for (const ShaderStage& stage : stages) key += (key.empty() ? "" : " + ") + stage.file;
    const std::string label = key;
    for (const auto& [name, value] : defines) key += " " + name + "=" + value;
    auto& program = programs_[key];
    if (!program) {
        std::vector<ShaderName> shaders;
        for (const ShaderStage& stage : stages) shaders.push_back(compile_shader(root_, stage, defines));
        program = std::make_unique<Program>(shaders, label);
    }
    return *program;
}

Program& ShaderLibrary::full_screen(const std::string& fragment_file, const ShaderDefines& defines) {
    return program({{GL_VERTEX_SHADER, "common/fullscreen.vert"}, {GL_FRAGMENT_SHADER, fragment_file}}, defines);
}

Program& ShaderLibrary::compute(const std::string& file, const ShaderDefines& defines) {
    return program({{GL_COMPUTE_SHADER, file}}, defines);
}

}  // namespace matchlight
