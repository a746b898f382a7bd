// Reads shader files, resolves #include with #line directives, translates locations in compiler logs.
#include "gl/shader_source.h"

#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>

#include <fmt/format.h>

#include "core/error.h"

namespace matchlight {

namespace {

// Mesa forgets the source number of undeclared names: lines carry it too. No shader has as many.
constexpr std::size_t lines_a_file = 100'000;

std::string line_directive(std::size_t line, std::size_t file) {
    return fmt::format("#line {} {}\n", file * lines_a_file + line, file);
}

class Assembler {
public:
    Assembler(const std::filesystem::path& root, const ShaderDefines& defines) : root_(root), defines_(defines) {}

    ShaderSource assemble(const std::string& file) {
        append(file, "");
        return std::move(source_);
    }

private:
    void append(const std::string& file, const std::string& included_from) {
        const std::filesystem::path path = root_ / file;
        std::ifstream stream(path);
        if (!stream) {
            throw InputError(
                path, included_from.empty() ? "cannot be read" : "cannot be read, included from " + included_from);
        }
        const std::size_t number = source_.files.size();
        source_.files.push_back(file);
        static const std::regex include_line(R"re(^\s*#\s*include\s+"([^"]+)"\s*$)re");
        static const std::regex version_line(R"(^\s*#\s*version\b.*$)");
        std::string line;
        for (int line_number = 1; std::getline(stream, line); ++line_number) {
            std::smatch match;
            if (std::regex_match(line, match, include_line)) {
                const std::string included = match[1];
                const std::string here = fmt::format("{}:{}", file, line_number);
                if (included.find("..") != std::string::npos || included.starts_with('/')) {
                    throw InputError(path, fmt::format("line {}: includes \"{}\", outside the shader folder",
                                                       line_number, included));
                }
                if (std::ranges::find(source_.files, included) == source_.files.end()) {
                    source_.text += line_directive(1, source_.files.size());
                    append(included, here);
                }
                source_.text += line_directive(static_cast<std::size_t>(line_number) + 1, number);
                continue;
            }
            const bool is_version = std::regex_match(line, version_line);
            if (number == 0 && line_number == 1 && !is_version) {
                throw InputError(path, "line 1: a shader starts with its #version");
            }
            source_.text += line + '\n';
            if (number == 0 && line_number == 1) {
                for (const auto& [name, value] : defines_) source_.text += fmt::format("#define {} {}\n", name, value);
                source_.text += line_directive(2, 0);
            }
        }
        if (number == 0 && source_.text.empty()) throw InputError(path, "is empty");
    }

    const std::filesystem::path& root_;
    const ShaderDefines& defines_;
    ShaderSource source_;
};

}  // namespace

ShaderSource assemble_shader(const std::filesystem::path& root, const std::string& file, const ShaderDefines& defines) {
    return Assembler(root, defines).assemble(file);
}

std::string with_file_names(const std::string& log, const std::vector<std::string>& files) {
    // Mesa: "0:12(5): error: …"; NVIDIA: "0(12) : error C…"; Intel and AMD: "ERROR: 0:12: …".
    static const std::regex location(R"(^((?:ERROR|WARNING): )?(\d+)[:(](\d+)\)?(.*)$)");
    std::istringstream lines(log);
    std::string translated;
    std::string line;
    while (std::getline(lines, line)) {
        std::smatch match;
        if (std::regex_match(line, match, location)) {
            const std::size_t numbered_line = std::stoul(match[3]);
            const std::size_t number = std::max<std::size_t>(std::stoul(match[2]), numbered_line / lines_a_file);
            if (number < files.size()) {
                line = fmt::format("{}{}:{}{}", match[1].str(), files[number], numbered_line % lines_a_file,
                                   match[4].str());
            }
        }
        if (line.empty()) continue;
        if (!translated.empty()) translated += "; ";
        translated += line;
    }
    return translated;
}

}  // namespace matchlight
