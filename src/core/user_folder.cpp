// Environment variables alone; nothing is made.
#include "core/user_folder.h"

#include <cstdlib>

namespace matchlight {

namespace {

std::optional<std::filesystem::path> absolute_in(const char* variable) {
    const char* value = std::getenv(variable);
    if (value == nullptr || !std::filesystem::path(value).is_absolute()) return std::nullopt;
    return std::filesystem::path(value);
}

}  // namespace

std::optional<std::filesystem::path> user_folder(const char* variable, const std::filesystem::path& below_home) {
    if (auto named = absolute_in(variable)) return named;
    if (const auto home = absolute_in("HOME")) return *home / below_home;
    return std::nullopt;
}

}  // namespace matchlight
