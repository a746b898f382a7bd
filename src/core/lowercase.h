// Names and endings of files compared without regard to upper and lower case.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace matchlight {

/// The letters A to Z made small, whatever the locale; every other byte as it is.
std::string lowercase(std::string_view text);

/// ".exr" of "Shot.EXR"; empty where there is none.
std::string lowercase_extension(const std::filesystem::path& path);

}  // namespace matchlight
