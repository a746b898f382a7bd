// Checks that come before any allocation.
#include "media/input_limits.h"

#include <system_error>

#include <fmt/format.h>

#include "core/error.h"

namespace matchlight {

namespace fs = std::filesystem;

void check_image_size(const fs::path& path, std::int64_t width, std::int64_t height) {
    if (width <= 0 || height <= 0)
        throw InputError(path, fmt::format("its header gives an empty picture ({}x{})", width, height));
    if (width > max_image_side || height > max_image_side || width * height > max_image_pixels)
        throw InputError(path, fmt::format("its header claims {}x{} pixels", width, height),
                         fmt::format("at most {} a side and {} in all are read", max_image_side, max_image_pixels));
}

void require_regular_file(const fs::path& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) throw InputError(path, "no such file");
    if (fs::is_directory(status)) throw InputError(path, "is a folder", "name a file");
    if (!fs::is_regular_file(status)) throw InputError(path, "is not a regular file");
    const std::uintmax_t size = fs::file_size(path, error);
    if (error) throw InputError(path, "cannot be read: " + error.message());
    if (size == 0) throw InputError(path, "the file is empty (zero bytes)");
}

}  // namespace matchlight
