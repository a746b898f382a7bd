// Compiles the programs of shaders/, each variant once.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
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

    const std::filesystem::path& root() const { return root_; }

private:
    std::filesystem::path root_;
    std::map<std::string, std::unique_ptr<Program>> programs_;
};

/// Compiles one stage. Throws InputError naming file and line.
ShaderName compile_shader(const std::filesystem::path& root, const ShaderStage& stage, const ShaderDefines& defines);

}  // namespace matchlight
