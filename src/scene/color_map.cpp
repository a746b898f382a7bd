// Each map is kept as 33 colours, evenly spaced, with straight lines between: within 3 code values of the maps' own
// tables of 256, cividis within 6.
#include "scene/color_map.h"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <string>

namespace matchlight {
namespace {

struct ColorMap {
    std::string_view name;
    std::string_view colors;  // RRGGBB after RRGGBB
};

// viridis, plasma, inferno, magma: van der Walt & Smith 2015, Matplotlib's (CC0). cividis: Nuñez, Anderton & Renslow
// 2018, "Optimizing colormaps with consideration for color vision deficiency to enable accurate interpretation of
// scientific data". turbo: Mikhailov 2019. coolwarm: computed after Moreland 2009, "Diverging Color Maps for Scientific
// Visualization".
constexpr ColorMap color_maps[] = {
    {"viridis",
     "440154470d6048186a482374472d7b4537814240863e49893b528b375b8d33638d2f6b8e2c728e297a8e26828e23898e21918d"
     "1f978b1f9f8821a68527ad8131b57b3ebc744dc26c5dc8636ece5882d34d95d840aadc32c0df25d5e21aeae51afde725"},
    {"plasma",
     "0d08872206903105973f049c4c02a15901a56600a77201a87e03a88909a59511a19f1a9ca92395b32c8ebc3587c43e7fcc4779"
     "d25071d9596adf6263e56b5deb7556f07f4ff48a48f89441fb9f3afdab33feb72dfdc328fcd025f9dd25f5eb27f0f921"},
    {"inferno",
     "0000040403120b0724150b37210c4a2f0a5b3d09654a0c6b57106e63156e70196e7d1e6d89226a962766a32c61af315bbb3755"
     "c63d4dd14545da4f3ce35932eb6529f1721ef67f14f98d0afb9b06fcaa0ffbba1ff9c932f5d949f2e865f3f586fcffa4"},
    {"magma",
     "0000040303120a0822130d341d114729115a36106b440f7651127c5d177f691c817621818226818f2a819c2e7fa9337db6377a"
     "c33b75cf4070db476ae65164ee5c5ef46a5cf9785dfb8861fd9668fea571feb47bfec287fed194fde0a1fceeb0fcfdbf"},
    {"cividis",
     "00224e00285b002e6a0533711a386f273e6e32436d3b496c434e6c4b546c535a6d5a5f6e61656f686a716f70737676767d7c78"
     "8381798b8778928d789a9376a29975aaa073b3a670bbad6dc3b369ccba64d4c15fddc858e6d051efd748f8df3cfee838"},
    {"turbo",
     "30123b392a734040a24456c7466be34680f64293ff37a7fa29bbec1dccd918dcc31ee8b031f2994cf97e6bfe648aff4ca3fd3d"
     "b8f735cced34dee037edd03af7c03afdad35fe982cfb8022f56818ec520fe14109d23105c12302ac1701950d017a0403"},
    {"coolwarm",
     "3b4cc0445acc4e68d75875e16282ea6c8ef1779af782a5fb8db0fe98b9ffa3c2ffaec9fdb8d0f9c2d5f4ccd9eed5dbe6dddddd"
     "e5d8d1ecd3c6f1ccb9f5c4adf7bba0f7b194f7a687f49a7bf18d6fec7f63e57057de614cd55042cb3e38c0282fb40426"},
    {"grey", "000000ffffff"},
};

int component(const ColorMap& map, std::size_t color, std::size_t channel) {
    int value = 0;
    const char* digits = map.colors.data() + 6 * color + 2 * channel;
    std::from_chars(digits, digits + 2, value, 16);
    return value;
}

}  // namespace

const std::vector<std::string_view>& color_map_names() {
    static const std::vector<std::string_view> names = [] {
        std::vector<std::string_view> all;
        for (const ColorMap& map : color_maps) all.push_back(map.name);
        return all;
    }();
    return names;
}

std::vector<std::array<std::uint8_t, 4>> color_map_table(std::size_t map) {
    constexpr std::size_t entries = 256;
    const ColorMap& chosen = color_maps[map];
    const std::size_t last = chosen.colors.size() / 6 - 1;
    std::vector<std::array<std::uint8_t, 4>> table(entries, {0, 0, 0, 255});
    for (std::size_t i = 0; i < entries; ++i) {
        const double at = static_cast<double>(i * last) / (entries - 1);
        const auto from = static_cast<std::size_t>(at);
        const std::size_t to = from < last ? from + 1 : last;
        const double share = at - static_cast<double>(from);
        for (std::size_t c = 0; c < 3; ++c) {
            const double value = (1 - share) * component(chosen, from, c) + share * component(chosen, to, c);
            table[i][c] = static_cast<std::uint8_t>(std::lround(value));
        }
    }
    return table;
}

}  // namespace matchlight
