// First bytes and outer structure of still images.
#include "media/picture_format.h"

#include <array>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "core/error.h"
#include "media/input_limits.h"

extern "C" {
#include <libavutil/crc.h>
}

namespace matchlight {

namespace {

namespace fs = std::filesystem;
using namespace std::string_view_literals;

std::uint32_t big_endian(std::string_view bytes) {
    std::uint32_t value = 0;
    for (const char c : bytes.substr(0, 4)) value = value << 8 | static_cast<unsigned char>(c);
    return value;
}

/// libpng prints on standard error what it finds broken, so the chunks are checked first: each whole, with its CRC
/// (ISO/IEC 15948, 5.3), a header within the limits first, some pixels, down to IEND.
void require_png_chunks(const fs::path& path, std::string_view bytes) {
    std::string_view rest = bytes.substr(8);
    bool has_pixels = false;
    while (rest.size() >= 12) {
        const std::size_t length = big_endian(rest);
        if (length > rest.size() - 12) break;
        const std::string_view type_and_data = rest.substr(4, 4 + length);
        const std::uint32_t crc =
            ~av_crc(av_crc_get_table(AV_CRC_32_IEEE_LE), ~0u,
                    reinterpret_cast<const std::uint8_t*>(type_and_data.data()), type_and_data.size());
        if (crc != big_endian(rest.substr(8 + length))) throw InputError(path, "is damaged", "copy it again");
        if (rest.size() + 8 == bytes.size()) {
            if (!type_and_data.starts_with("IHDR"sv) || length != 13) break;
            check_image_size(path, big_endian(type_and_data.substr(4)), big_endian(type_and_data.substr(8)));
        }
        has_pixels = has_pixels || type_and_data.starts_with("IDAT"sv);
        if (type_and_data.starts_with("IEND"sv) && has_pixels) return;
        rest.remove_prefix(12 + length);
    }
    throw InputError(path, "ends early", "copy it again");
}

/// libjpeg fills what is missing of a cut file with grey and calls that success, so look for the end marker: it must
/// follow the last scan, though some cameras append data of their own after it.
void require_jpeg_end(const fs::path& path, std::string_view bytes) {
    const std::size_t last_scan = bytes.rfind("\xff\xda"sv);
    if (last_scan == std::string_view::npos || bytes.find("\xff\xd9"sv, last_scan) == std::string_view::npos)
        throw InputError(path, "ends early", "copy it again");
}

}  // namespace

PictureFormat recognise_picture(const fs::path& path) {
    require_regular_file(path);
    std::array<char, 12> buffer{};
    std::ifstream stream(path, std::ios::binary);
    stream.read(buffer.data(), buffer.size());
    if (stream.gcount() == 0) throw InputError(path, "cannot be read");
    const std::string_view head(buffer.data(), static_cast<std::size_t>(stream.gcount()));
    if (head.starts_with("\x89PNG\r\n\x1a\n"sv)) return PictureFormat::png;
    if (head.starts_with("\xff\xd8\xff"sv)) return PictureFormat::jpeg;
    if (head.starts_with("II*\0"sv) || head.starts_with("MM\0*"sv)) return PictureFormat::tiff;
    if (head.starts_with("BM"sv)) return PictureFormat::bmp;
    if (head.size() > 2 && head[0] == 'P' && head[1] >= '1' && head[1] <= '6' &&
        std::isspace(static_cast<unsigned char>(head[2])) != 0)
        return PictureFormat::pnm;
    if (head.starts_with("RIFF"sv) && head.substr(8).starts_with("WEBP"sv)) return PictureFormat::webp;
    if (head.starts_with("#?"sv)) return PictureFormat::radiance;
    if (head.starts_with("\x76\x2f\x31\x01"sv)) return PictureFormat::exr;
    // Targa has no mark at its start.
    if (path.extension() == ".tga" || path.extension() == ".TGA") return PictureFormat::targa;
    throw InputError(path, "is no picture of a known format",
                     "PNG, JPEG, TIFF, BMP, PNM, Targa, WebP, EXR and Radiance HDR are read");
}

void require_whole_picture(const fs::path& path, PictureFormat format) {
    if (format != PictureFormat::png && format != PictureFormat::jpeg) return;  // their readers report it themselves
    std::ifstream stream(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    if (format == PictureFormat::png) require_png_chunks(path, bytes);
    if (format == PictureFormat::jpeg) require_jpeg_end(path, bytes);
}

}  // namespace matchlight
