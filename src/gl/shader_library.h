// Compiles the programs of shaders/, each variant once, and again where its files change.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "gl/program.h"
#include "gl/shader_source.h"

namespace matchlight {

struct ShaderStage {
    GLenum stage = GL_FRAGMENT_SHADER;
    std::string file;  // relative to the root: "surface/surface.frag"
};

/// The folder of shaders: $MATCHLIGHT_SHADERS, else share/matchlight/shaders beside the executable's folder (an
/// installation), else the source tree it was built from. Throws InputError when none is there.
std::filesystem::path shader_root();

/// What came of looking for changed shader files.
struct ShaderReload {
    bool files_changed = false;         // since the last look
    std::vector<std::string> reloaded;  // labels of the programs that are new
    std::vector<std::string> errors;    // each once; the programs concerned stay as they were
};

/// Programs of one context, by stages and definitions. Files end in .vert, .frag, .geom, .comp, or .glsl for includes.
class ShaderLibrary {
public:
    explicit ShaderLibrary(std::filesystem::path root = shader_root());

    /// The program, compiled when first asked for; the reference lives as long as the library. Throws InputError
    /// naming file and line.
    Program& program(const std::vector<ShaderStage>& stages, const ShaderDefines& defines = {});
    /// common/fullscreen.vert with this fragment shader, for FullScreenTriangle.
    Program& full_screen(const std::string& fragment_file, const ShaderDefines& defines = {});
    Program& compute(const std::string& file, const ShaderDefines& defines = {});

    /// Makes anew, in their places, the programs that were made of files changed since (includes too), and again those
    /// that could not be made the last time. Uniforms of a program that is new are zero.
    ShaderReload reload_changed();

    /// What was compiled so far: files and definitions, one text a program.
    std::vector<std::string> made_programs() const;

    const std::filesystem::path& root() const { return root_; }

private:
    /// When a file was written last, and its size.
    using FileStamps = std::map<std::string, std::pair<std::filesystem::file_time_type, std::uintmax_t>>;
    struct Entry {
        std::vector<ShaderStage> stages;
        ShaderDefines defines;
        std::string label;
        std::set<std::string> files;  // relative to the root
        bool failed = false;          // the last time it was made again
        std::unique_ptr<Program> program;
    };

    Program made(Entry& entry) const;
    FileStamps file_stamps() const;

    std::filesystem::path root_;
    FileStamps stamps_;
    std::map<std::string, Entry> entries_;
};

/// Compiles one stage. Throws InputError naming file and line. What it was put together from is added to `files`.
ShaderName compile_shader(const std::filesystem::path& root, const ShaderStage& stage, const ShaderDefines& defines,
                          std::set<std::string>* files = nullptr);

}  // namespace matchlight
