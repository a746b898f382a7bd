// Still images: PNG, JPEG and other pictures in and out, EXR through OpenEXR, each written whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/warnings.h"

namespace matchlight {

/// 3-channel 8-bit picture of any format OpenImageIO reads (grey is spread, alpha dropped, 16 bit is rounded). Checks
/// the header before allocating. Throws InputError.
Image8 read_rgb8(const std::filesystem::path& path);
/// 1-channel mask: non-zero is inside.
Image8 read_mask(const std::filesystem::path& path);

/// Linear float RGB of .exr or .hdr (channels R, G, B by name, or Y). NaN → 0, ±Inf and beyond half range clamped,
/// both counted as warnings. Limits are checked before allocating. Throws InputError: truncated, no RGB channels,
/// absurd data windows or channel counts.
ImageF read_linear_rgb(const std::filesystem::path& path, Warnings& warnings);

void write_png8(const std::filesystem::path& path, const Image8& pixels);  // 1, 3 or 4 channels
void write_png16(const std::filesystem::path& path, const Image16& pixels);

/// One part of a multi-part EXR: named channels of one image, stored half or float.
struct ExrPart {
    std::string name;                   // "beauty", "depth", …
    std::vector<std::string> channels;  // "R", "G", "B", "A", "Z", …, as many as the image has
    const ImageF* image = nullptr;
    bool half = true;
    Region data_window;  // where the image lies in the display window; empty = all of it
};
/// ZIP-compressed scanlines; `metadata` goes into every part's header as strings. Throws InputError.
void write_exr(const std::filesystem::path& path, int display_width, int display_height,
               const std::vector<ExrPart>& parts, const std::map<std::string, std::string>& metadata);

/// "out_%04d.png" with the frame's number put in; a name without a pattern is returned as it is. Throws InputError for
/// a pattern that is not a single %d or %0Nd.
std::filesystem::path numbered(const std::filesystem::path& pattern, std::int64_t number);
bool is_pattern(const std::filesystem::path& path);

}  // namespace matchlight
