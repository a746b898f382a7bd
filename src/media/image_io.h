// Still images: PNG, JPEG and other pictures in and out, EXR through OpenEXR, each written whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/warnings.h"

namespace matchlight {

/// 3-channel picture of a PNG, JPEG, TIFF, BMP, PNM, Targa or WebP file, recognised by its first bytes: grey is spread,
/// alpha dropped, 16 bit rounded to 8 (or 8 widened to 16), EXIF orientation applied. Checks the header before
/// allocating. Throws InputError.
Image8 read_rgb8(const std::filesystem::path& path);
Image16 read_rgb16(const std::filesystem::path& path);
/// Bits a sample of such a picture: 8 or 16.
int picture_bit_depth(const std::filesystem::path& path);
/// 1-channel mask: non-zero in any colour channel is inside (255), else 0.
Image8 read_mask(const std::filesystem::path& path);

/// How many samples of an image were no light.
struct SampleRepairs {
    std::int64_t not_a_number = 0;
    std::int64_t infinite = 0;
    std::int64_t beyond_half = 0;  // finite but above 65504: kept
};

/// Linear float RGB of .exr or .hdr (channels R, G, B by name, of the first part that has them, or Y; the data window
/// is placed in the display window). NaN → 0 and ±Inf → ±65504, counted as warnings. Finite values beyond half range
/// are kept (a sun of 1e5 is still light to integrate; whoever uploads to half floats clamps) but warned of. Limits are
/// checked before allocating. Throws InputError: truncated, no RGB channels, absurd windows or channel counts, deep.
/// Counts go to `repairs` where given.
ImageF read_linear_rgb(const std::filesystem::path& path, Warnings& warnings, SampleRepairs* repairs = nullptr);

/// Named channels of a part of an EXR file as they are stored, over the display window (0 outside the data window).
/// Throws InputError when the part or a channel is missing.
ImageF read_exr_part(const std::filesystem::path& path, const std::string& part,
                     const std::vector<std::string>& channels);
/// "latlong" or "cube" where an EXR header's `envmap` attribute says so.
std::optional<std::string> exr_envmap(const std::filesystem::path& path);

/// Recorded in the file beside the pixels, such as the effective scene, version and seed.
using ImageMetadata = std::map<std::string, std::string>;

/// 1, 3 or 4 channels, sRGB; alpha, where there is any, as PNG has it: not premultiplied. The resolution, where given,
/// tells printers how large the picture is. Throws InputError.
void write_png8(const std::filesystem::path& path, const Image8& pixels, const ImageMetadata& metadata = {},
                double pixels_per_inch = 0);
void write_png16(const std::filesystem::path& path, const Image16& pixels, const ImageMetadata& metadata = {});

/// One part of a multi-part EXR: named channels of one image, stored half or float.
struct ExrPart {
    std::string name;                   // "beauty", "depth", …
    std::vector<std::string> channels;  // "R", "G", "B", "A", "Z", …, as many as the image has
    const ImageF* image = nullptr;
    bool half = true;
    Region data_window;           // where the image lies in the display window; empty = at its origin
    ImageMetadata metadata = {};  // of this part alone
    bool rec709 = false;          // its RGB is light of Rec.709's primaries: told in the standard attribute
};
/// ZIP-compressed scanlines; `metadata` goes into every part's header as strings. Throws InputError.
void write_exr(const std::filesystem::path& path, int display_width, int display_height,
               const std::vector<ExrPart>& parts, const ImageMetadata& metadata);

/// "out_%04d.png" with the frame's number put in; a name without a pattern is returned as it is. Throws InputError for
/// a pattern that is not a single %d or %0Nd.
std::filesystem::path numbered(const std::filesystem::path& pattern, std::int64_t number);
bool is_pattern(const std::filesystem::path& path);
/// The numbers of the files that have a name of the pattern, in order. Throws InputError where the folder cannot be
/// read.
std::vector<std::int64_t> numbers_of_pattern(const std::filesystem::path& pattern);

}  // namespace matchlight
