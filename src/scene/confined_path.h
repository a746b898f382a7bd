// Names of files that a model's file mentions: only files inside the model's own folder are meant.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace matchlight {

/// Where a model lies and what its file is called in messages.
struct ModelFolder {
    std::filesystem::path model;

    /// The file that `name` (already percent-decoded, forward or back slashes) means. Throws InputError naming the
    /// model for an absolute name, one with "..", one with a scheme ("http:", "C:"), and one that a symbolic link leads
    /// out of the folder. The file need not exist.
    std::filesystem::path inside(const std::string& name) const;
};

/// "%20" becomes a space (RFC 3986); a % that no two hexadecimal digits follow stays.
std::string percent_decoded(std::string_view text);

/// Reads a whole binary file that exists. Throws InputError naming `path`: not a regular file, unreadable, or larger
/// than the memory there is.
std::string read_binary_file(const std::filesystem::path& path);

}  // namespace matchlight
