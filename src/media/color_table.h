// Look-up tables of colour grading, read by OpenColorIO.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

namespace matchlight {

/// A colour for each colour of a cube: `size` codes from 0 to 1 a channel, red fastest.
struct ColorTable {
    int size = 0;
    std::vector<float> rgb;

    const float* at(int red, int green, int blue) const {
        return &rgb[3 * ((static_cast<std::size_t>(blue) * size + green) * size + red)];
    }
    /// Linear within each of the six tetrahedra that share a cell's diagonal from black to white; beyond 0 to 1 as at
    /// its faces. Kasson et al. 1993, "Tetrahedral interpolation technique for color space conversion".
    std::array<double, 3> operator()(const std::array<double, 3>& code) const;
};

/// Nodes of the tables that read_color_table makes: those of cubes of 2, 3, 5, 9, 17, 33 and 65 are among them, so that
/// these lose nothing.
inline constexpr int color_table_size = 65;

/// Any file that OpenColorIO reads as a transform (.cube, .3dl, .csp, .spi1d, .spi3d, .clf, …). Throws InputError: not
/// readable, no such table, colours that are not finite.
ColorTable read_color_table(const std::filesystem::path& path);

}  // namespace matchlight
