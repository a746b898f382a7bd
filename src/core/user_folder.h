// Where a user's caches and settings lie.
#pragma once

#include <filesystem>
#include <optional>

namespace matchlight {

/// The folder that the variable names ("XDG_CACHE_HOME"), else `below_home` (".cache") in the user's home; nullopt
/// where neither is known. Relative paths are ignored (the XDG Base Directory Specification).
std::optional<std::filesystem::path> user_folder(const char* variable, const std::filesystem::path& below_home);

}  // namespace matchlight
