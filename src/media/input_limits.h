// What an input may claim before memory is given to it.
#pragma once

#include <cstdint>
#include <filesystem>

namespace matchlight {

/// 16K × 8K pixels: the largest light probes in circulation. As RGB floats that is 1.6 GB.
inline constexpr std::int64_t max_image_pixels = std::int64_t{1} << 27;
inline constexpr int max_image_side = 32768;
/// Layered renders have some hundred channels; thousands are damage or an attack.
inline constexpr int max_image_channels = 1024;

/// Throws InputError unless the size is positive and within the limits.
void check_image_size(const std::filesystem::path& path, std::int64_t width, std::int64_t height);

/// Throws InputError unless `path` names a regular file with at least one byte. FIFOs, devices and folders would block
/// or never end.
void require_regular_file(const std::filesystem::path& path);

}  // namespace matchlight
