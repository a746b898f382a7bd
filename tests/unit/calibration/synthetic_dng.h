// The smallest raw file that LibRaw reads: an even picture behind a Bayer pattern, as DNG (Adobe, DNG 1.4).
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace matchlight {

struct SyntheticDng {
    int width = 64, height = 48;
    std::uint16_t level = 8000, white = 16383;  // of every photosite
    std::uint32_t time_divisor = 30;            // 1/30 s
    std::uint32_t f_number = 8;
    std::uint16_t iso = 100;

    std::string bytes() const {
        const std::uint32_t exif_at = 8;
        const std::string exif = directory(
            {rational(33434, {1, time_divisor}), rational(33437, {f_number, 1}), shorts(34855, {iso})}, exif_at);
        const std::uint32_t main_at = exif_at + static_cast<std::uint32_t>(exif.size());
        // The length does not depend on where the pixels lie.
        const std::uint32_t pixels_at =
            main_at + static_cast<std::uint32_t>(directory(main_entries(exif_at, 0), main_at).size());
        std::string file = "II";
        append(file, 42, 2);
        append(file, main_at, 4);
        file += exif + directory(main_entries(exif_at, pixels_at), main_at);
        for (int i = 0; i < width * height; ++i) append(file, level, 2);
        return file;
    }

private:
    struct Entry {
        std::uint16_t tag, type;
        std::uint32_t count;
        std::string value;
    };

    static void append(std::string& text, std::uint32_t value, int bytes) {
        for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 0xff);
    }
    static Entry numbers(std::uint16_t tag, std::uint16_t type, int bytes, const std::vector<std::uint32_t>& values) {
        Entry entry{tag, type, static_cast<std::uint32_t>(values.size()), {}};
        for (const std::uint32_t value : values) append(entry.value, value, bytes);
        return entry;
    }
    static Entry raw_bytes(std::uint16_t tag, const std::vector<std::uint32_t>& v) { return numbers(tag, 1, 1, v); }
    static Entry shorts(std::uint16_t tag, const std::vector<std::uint32_t>& v) { return numbers(tag, 3, 2, v); }
    static Entry longs(std::uint16_t tag, const std::vector<std::uint32_t>& v) { return numbers(tag, 4, 4, v); }
    static Entry text(std::uint16_t tag, const std::string& value) {
        return {tag, 2, static_cast<std::uint32_t>(value.size() + 1), value + '\0'};
    }
    /// Pairs of numerator and denominator.
    static Entry rational(std::uint16_t tag, const std::vector<std::uint32_t>& v, std::uint16_t type = 5) {
        Entry entry = numbers(tag, type, 4, v);
        entry.count /= 2;
        return entry;
    }

    std::vector<Entry> main_entries(std::uint32_t exif_at, std::uint32_t pixels_at) const {
        const auto w = static_cast<std::uint32_t>(width), h = static_cast<std::uint32_t>(height);
        // XYZ to the camera's colours: those of sRGB, in ten-thousandths (IEC 61966-2-1).
        std::vector<std::uint32_t> matrix;
        for (const int value : {32405, -15371, -4985, -9693, 18760, 416, 556, -2040, 10573}) {
            matrix.push_back(static_cast<std::uint32_t>(value));
            matrix.push_back(10000);
        }
        return {longs(254, {0}),
                longs(256, {w}),
                longs(257, {h}),
                shorts(258, {16}),
                shorts(259, {1}),
                shorts(262, {32803}),  // colour filter array
                text(271, "Matchlight"),
                text(272, "Synthetic"),
                longs(273, {pixels_at}),
                shorts(274, {1}),
                shorts(277, {1}),
                longs(278, {h}),
                longs(279, {2 * w * h}),
                shorts(284, {1}),
                shorts(33421, {2, 2}),
                raw_bytes(33422, {0, 1, 1, 2}),
                longs(34665, {exif_at}),
                raw_bytes(50706, {1, 4, 0, 0}),
                text(50708, "Synthetic"),
                longs(50714, {0}),
                longs(50717, {white}),
                rational(50721, matrix, 10),
                rational(50728, {1, 1, 1, 1, 1, 1}),
                shorts(50778, {21})};  // D65
    }

    /// A TIFF directory that stands at `at`, with the values that do not fit into it behind it.
    static std::string directory(const std::vector<Entry>& entries, std::uint32_t at) {
        std::string table, values;
        append(table, static_cast<std::uint32_t>(entries.size()), 2);
        const auto values_at = static_cast<std::uint32_t>(at + 2 + 12 * entries.size() + 4);
        for (const Entry& entry : entries) {
            append(table, entry.tag, 2);
            append(table, entry.type, 2);
            append(table, entry.count, 4);
            if (entry.value.size() <= 4) {
                table += entry.value + std::string(4 - entry.value.size(), '\0');
                continue;
            }
            append(table, values_at + static_cast<std::uint32_t>(values.size()), 4);
            values += entry.value;
            if (values.size() % 2 != 0) values += '\0';
        }
        append(table, 0, 4);
        return table + values;
    }
};

}  // namespace matchlight
