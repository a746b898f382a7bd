// Refuses names that lead out of a model's folder.
#include "scene/confined_path.h"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>

#include "core/error.h"
#include "core/memory.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

bool is_hex(char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
}

int hex_value(char c) {
    if (c <= '9') return c - '0';
    return (c | 0x20) - 'a' + 10;
}

bool is_inside(const fs::path& folder, const fs::path& file) {
    const auto [end_of_folder, rest] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
    return end_of_folder == folder.end() && rest != file.end();
}

}  // namespace

std::string percent_decoded(std::string_view text) {
    std::string decoded;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '%' && i + 2 < text.size() && is_hex(text[i + 1]) && is_hex(text[i + 2])) {
            decoded += static_cast<char>(hex_value(text[i + 1]) * 16 + hex_value(text[i + 2]));
            i += 2;
        } else {
            decoded += text[i];
        }
    }
    return decoded;
}

fs::path ModelFolder::inside(const std::string& name) const {
    std::string slashed = name;
    std::replace(slashed.begin(), slashed.end(), '\\', '/');
    const auto refuse = [&](const char* why) {
        throw InputError(model, fmt::format("it names the file '{}', {}", name.substr(0, 200), why),
                         "files of a model lie in its folder");
    };
    if (slashed.empty() || slashed.find('\0') != std::string::npos) refuse("which is no file name");
    if (slashed.front() == '/') refuse("an absolute path");
    const std::size_t colon = slashed.find(':');
    if (colon != std::string::npos && slashed.find('/') > colon) refuse("which has a scheme");
    for (const fs::path& part : fs::path(slashed)) {
        if (part == "..") refuse("which leaves the model's folder");
    }
    const fs::path folder = model.has_parent_path() ? model.parent_path() : fs::path(".");
    std::error_code failure;
    const fs::path real_folder = fs::canonical(folder, failure);
    if (failure) throw InputError(model, "its folder cannot be read: " + failure.message());
    const fs::path real_file = fs::weakly_canonical(folder / slashed, failure);
    if (failure || !is_inside(real_folder, real_file)) refuse("which a symbolic link leads out of the model's folder");
    return folder / slashed;
}

std::string read_binary_file(const fs::path& path) {
    std::error_code failure;
    if (!fs::is_regular_file(path, failure)) throw InputError(path, "there is no such regular file");
    const std::uintmax_t size = fs::file_size(path, failure);
    if (failure) throw InputError(path, "its size cannot be read: " + failure.message());
    // The bytes and what is made of them are in memory together.
    if (size > available_memory_bytes() / 2) {
        throw InputError(path, fmt::format("its {} MB do not fit into memory", size >> 20));
    }
    std::string bytes(size, '\0');
    std::ifstream file(path, std::ios::binary);
    if (!file.read(bytes.data(), static_cast<std::streamsize>(size))) throw InputError(path, "it cannot be read");
    return bytes;
}

}  // namespace matchlight
