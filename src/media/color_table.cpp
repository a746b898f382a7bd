// OpenColorIO applies the file to a cube of colours.
#include "media/color_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>

#include "core/error.h"

namespace matchlight {

namespace OCIO = OCIO_NAMESPACE;

std::array<double, 3> ColorTable::operator()(const std::array<double, 3>& code) const {
    std::array<int, 3> low{};
    std::array<double, 3> share{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double place = std::clamp(code[c], 0.0, 1.0) * (size - 1);
        low[c] = std::min(static_cast<int>(place), size - 2);
        share[c] = place - low[c];
    }
    // From black's corner to white's, along the channel with the greatest share first.
    std::array<std::size_t, 3> order{0, 1, 2};
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return share[a] > share[b]; });
    std::array<double, 3> color{};
    double left = 1;
    for (std::size_t step = 0; step <= 3; ++step) {
        const double next = step < 3 ? share[order[step]] : 0;
        const float* node = at(low[0], low[1], low[2]);
        for (std::size_t c = 0; c < 3; ++c) color[c] += (left - next) * static_cast<double>(node[c]);
        left = next;
        if (step < 3) ++low[order[step]];
    }
    return color;
}

ColorTable read_color_table(const std::filesystem::path& path) {
    constexpr int size = color_table_size;
    ColorTable table{.size = size, .rgb = std::vector<float>(static_cast<std::size_t>(3) * size * size * size)};
    std::size_t i = 0;
    for (int blue = 0; blue < size; ++blue) {
        for (int green = 0; green < size; ++green) {
            for (int red = 0; red < size; ++red) {
                for (const int code : {red, green, blue}) table.rgb[i++] = static_cast<float>(code) / (size - 1);
            }
        }
    }
    try {
        // Files are kept by their names alone: one that was changed would be read as it was.
        OCIO::ClearAllCaches();
        const OCIO::FileTransformRcPtr file = OCIO::FileTransform::Create();
        file->setSrc(path.string().c_str());
        file->setInterpolation(OCIO::INTERP_BEST);
        const OCIO::ConstConfigRcPtr config = OCIO::Config::CreateRaw();
        const OCIO::ConstCPUProcessorRcPtr processor = config->getProcessor(file)->getDefaultCPUProcessor();
        OCIO::PackedImageDesc colors(table.rgb.data(), static_cast<long>(size) * size, size, 3);
        processor->apply(colors);
    } catch (const OCIO::Exception& error) {
        std::string cause = error.what();
        std::ranges::replace(cause, '\n', ' ');
        throw InputError(path, fmt::format("is no look-up table ({})", printable(cause)),
                         "give a .cube, .3dl, .csp, .spi1d or .spi3d file");
    }
    if (!std::ranges::all_of(table.rgb, [](float value) { return std::isfinite(value); }))
        throw InputError(path, "holds colours that are not finite", "mend the table");
    return table;
}

}  // namespace matchlight
