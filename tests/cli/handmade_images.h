// EXR and Radiance files written byte by byte, so that tests can make sound ones and lie in any field.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace matchlight::test {

/// An uncompressed scan-line EXR of 32-bit float channels.
struct HandmadeExr {
    int width = 8, height = 4;
    std::vector<std::string> channels = {"B", "G", "R"};  // in alphabetical order, as the format asks
    std::function<float(int x, int y, int channel)> sample = [](int, int, int) { return 1.0f; };
    std::array<std::int32_t, 4> data_window = {0, 0, -1, -1};  // said in the header; {0, 0, −1, −1}: the true one
    char compression = 0;                                      // said in the header: 0 none, 1 RLE
    std::string type = {};                                     // such as "deepscanline"; none unless given
    std::uint32_t version_flags = 0;
    std::string line_bytes = {};  // what every line's data is instead of its samples
    std::string envmap = {};      // one byte of the `envmap` attribute; none unless given

    std::string bytes() const {
        std::string file;
        put(file, std::int32_t{20000630});  // magic number of the format
        put(file, static_cast<std::uint32_t>(2 | version_flags));
        std::string list;
        for (const std::string& name : channels) {
            list += name + '\0';
            for (const std::int32_t field : {2, 0, 1, 1}) put(list, field);  // float, not linear, no subsampling
        }
        list += '\0';
        attribute(file, "channels", "chlist", list);
        attribute(file, "compression", "compression", std::string(1, compression));
        std::string window;
        const bool honest = data_window == std::array<std::int32_t, 4>{0, 0, -1, -1};
        for (const std::int32_t edge :
             honest ? std::array<std::int32_t, 4>{0, 0, width - 1, height - 1} : data_window) {
            put(window, edge);
        }
        attribute(file, "dataWindow", "box2i", window);
        attribute(file, "displayWindow", "box2i", window);
        if (!envmap.empty()) attribute(file, "envmap", "envmap", envmap);
        attribute(file, "lineOrder", "lineOrder", std::string(1, '\0'));
        attribute(file, "pixelAspectRatio", "float", floats({1}));
        attribute(file, "screenWindowCenter", "v2f", floats({0, 0}));
        attribute(file, "screenWindowWidth", "float", floats({1}));
        if (!type.empty()) attribute(file, "type", "string", type);
        file += '\0';
        const std::size_t data_bytes =
            line_bytes.empty() ? channels.size() * static_cast<std::size_t>(width) * 4 : line_bytes.size();
        const std::size_t first_line = file.size() + static_cast<std::size_t>(height) * 8;
        for (int y = 0; y < height; ++y) {
            put(file, static_cast<std::uint64_t>(first_line + static_cast<std::size_t>(y) * (data_bytes + 8)));
        }
        for (int y = 0; y < height; ++y) {
            put(file, static_cast<std::int32_t>(y));
            put(file, static_cast<std::int32_t>(data_bytes));
            if (!line_bytes.empty()) {
                file += line_bytes;
                continue;
            }
            for (std::size_t c = 0; c < channels.size(); ++c) {
                for (int x = 0; x < width; ++x) put(file, sample(x, y, static_cast<int>(c)));
            }
        }
        return file;
    }

private:
    template <class Value>
    static void put(std::string& to, Value value) {
        char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        to.append(bytes, sizeof value);
    }
    static std::string floats(std::initializer_list<float> values) {
        std::string text;
        for (const float value : values) put(text, value);
        return text;
    }
    static void attribute(std::string& file, const std::string& name, const std::string& type_name,
                          const std::string& value) {
        file += name + '\0' + type_name + '\0';
        put(file, static_cast<std::int32_t>(value.size()));
        file += value;
    }
};

/// A flat Radiance file of uniform light 1; the header may lie about the size. `brightness` gives mantissas (128 = 1)
/// in the order of the file.
inline std::string radiance_bytes(
    int width, int height, const std::string& said_size = {},
    const std::function<int(int index)>& brightness = [](int) { return 128; }) {
    const std::string size =
        said_size.empty() ? "-Y " + std::to_string(height) + " +X " + std::to_string(width) : said_size;
    std::string file = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + size + "\n";
    for (int i = 0; i < width * height; ++i) {
        file += std::string(3, static_cast<char>(brightness(i))) + '\x81';  // mantissa/256 × 2¹
    }
    return file;
}

}  // namespace matchlight::test
