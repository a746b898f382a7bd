// Names and endings of files compared without regard to upper and lower case.
#include "core/lowercase.h"

#include <algorithm>

namespace matchlight {

std::string lowercase(std::string_view text) {
    std::string result(text);
    std::ranges::transform(result, result.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return result;
}

std::string lowercase_extension(const std::filesystem::path& path) {
    return lowercase(path.extension().string());
}

}  // namespace matchlight
