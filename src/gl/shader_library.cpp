// Finds the shader folder, compiles stages, keeps linked programs, and makes them again when their files change.
#include "gl/shader_library.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>
#include <system_error>

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

ShaderName compile_shader(const fs::path& root, const ShaderStage& stage, const ShaderDefines& defines,
                          std::set<std::string>* files) {
    const ShaderSource source = assemble_shader(root, stage.file, defines);
    if (files != nullptr) files->insert(source.files.begin(), source.files.end());
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

ShaderLibrary::ShaderLibrary(fs::path root) : root_(std::move(root)), stamps_(file_stamps()) {}

Program& ShaderLibrary::program(const std::vector<ShaderStage>& stages, const ShaderDefines& defines) {
    std::string key;
    for (const ShaderStage& stage : stages) key += (key.empty() ? "" : " + ") + stage.file;
    const std::string label = key;
    for (const auto& [name, value] : defines) key += " " + name + "=" + value;
    const auto known = entries_.find(key);
    if (known != entries_.end()) return *known->second.program;
    Entry entry{.stages = stages, .defines = defines, .label = label, .files = {}, .program = nullptr};
    entry.program = std::make_unique<Program>(made(entry));
    return *entries_.emplace(key, std::move(entry)).first->second.program;
}

std::vector<std::string> ShaderLibrary::made_programs() const {
    std::vector<std::string> keys;
    for (const auto& [key, entry] : entries_) keys.push_back(key);
    return keys;
}

Program ShaderLibrary::made(Entry& entry) const {
    std::vector<ShaderName> shaders;
    for (const ShaderStage& stage : entry.stages) {
        shaders.push_back(compile_shader(root_, stage, entry.defines, &entry.files));
    }
    return {shaders, entry.label};
}

ShaderLibrary::FileStamps ShaderLibrary::file_stamps() const {
    // Editors leave files of their own beside those they write.
    constexpr std::array<std::string_view, 5> endings{".vert", ".frag", ".geom", ".comp", ".glsl"};
    FileStamps stamps;
    std::error_code error;
    for (fs::recursive_directory_iterator file(root_, error), end; !error && file != end; file.increment(error)) {
        if (std::ranges::find(endings, file->path().extension().string()) == endings.end()) continue;
        std::error_code vanished;
        const auto written = file->last_write_time(vanished);
        const auto size = vanished ? 0 : file->file_size(vanished);
        if (!vanished) stamps[file->path().lexically_relative(root_).string()] = {written, size};
    }
    return stamps;
}

ShaderReload ShaderLibrary::reload_changed() {
    const FileStamps before = std::exchange(stamps_, file_stamps());
    ShaderReload reload{.files_changed = stamps_ != before, .reloaded = {}, .errors = {}};
    if (!reload.files_changed) return reload;
    const auto changed = [&](const std::string& file) {
        const auto was = before.find(file);
        const auto is = stamps_.find(file);
        return was == before.end() || is == stamps_.end() || was->second != is->second;
    };
    for (auto& [key, entry] : entries_) {
        if (!entry.failed && std::ranges::none_of(entry.files, changed)) continue;
        try {
            *entry.program = made(entry);
            entry.failed = false;
            reload.reloaded.push_back(entry.label);
        } catch (const InputError& error) {
            entry.failed = true;
            if (std::ranges::find(reload.errors, error.what()) == reload.errors.end()) {
                reload.errors.emplace_back(error.what());
            }
        }
    }
    return reload;
}

Program& ShaderLibrary::full_screen(const std::string& fragment_file, const ShaderDefines& defines) {
    return program({{GL_VERTEX_SHADER, "common/fullscreen.vert"}, {GL_FRAGMENT_SHADER, fragment_file}}, defines);
}

Program& ShaderLibrary::compute(const std::string& file, const ShaderDefines& defines) {
    return program({{GL_COMPUTE_SHADER, file}}, defines);
}

}  // namespace matchlight
