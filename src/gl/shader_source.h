// Shader files with their includes put together, and the way back from a compiler's line numbers to files.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace matchlight {

/// Preprocessor definitions of one variant, name → value.
using ShaderDefines = std::map<std::string, std::string>;

struct ShaderSource {
    std::string text;                // what the compiler is given
    std::vector<std::string> files;  // by the source number of its #line directives, relative to the root
};

/// Reads `file` (relative to `root`), whose first line is its #version, puts the definitions after it and replaces each
/// `#include "common/x.glsl"` (relative to the root; a file is put in once) by the file. Throws InputError naming file
/// and line for a file that is missing, lies outside the root or has no #version.
ShaderSource assemble_shader(const std::filesystem::path& root, const std::string& file, const ShaderDefines& defines);

/// The log on one line, its "0:12(5)", "0(12)" or "ERROR: 0:12" locations turned into "surface/surface.frag:12".
std::string with_file_names(const std::string& log, const std::vector<std::string>& files);

}  // namespace matchlight
