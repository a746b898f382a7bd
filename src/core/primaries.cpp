// Matrices from chromaticities (SMPTE RP 177:1993, "Derivation of Basic Television Color Equations").
#include "core/primaries.h"

#include <array>

#include <Eigen/LU>

namespace matchlight {

namespace {

constexpr std::array<double, 2> d65{0.3127, 0.3290};

/// CIE x and y of red, green and blue.
using Chromaticities = std::array<std::array<double, 2>, 3>;
constexpr Chromaticities rec709{{{0.640, 0.330}, {0.300, 0.600}, {0.150, 0.060}}};   // ITU-R BT.709
constexpr Chromaticities rec2020{{{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}}};  // ITU-R BT.2020
constexpr Chromaticities p3{{{0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}}};       // SMPTE EG 432-1

Eigen::Vector3d xyz_of(const std::array<double, 2>& xy) {
    return {xy[0] / xy[1], 1, (1 - xy[0] - xy[1]) / xy[1]};
}

Eigen::Matrix3d xyz_from(const Chromaticities& chromaticities) {
    Eigen::Matrix3d colors;
    for (int i = 0; i < 3; ++i) colors.col(i) = xyz_of(chromaticities[static_cast<std::size_t>(i)]);
    const Eigen::Vector3d amounts = colors.inverse() * xyz_of(d65);
    return colors * amounts.asDiagonal();
}

struct Ways {
    Eigen::Matrix3d to_rec709, from_rec709;
};

Ways ways_of(const Chromaticities& chromaticities) {
    const Eigen::Matrix3d to_rec709 = xyz_from(rec709).inverse() * xyz_from(chromaticities);
    return {to_rec709, to_rec709.inverse()};
}

const Ways& ways_of(Primaries primaries) {
    // Exactly the identity, so that footage of Rec.709 keeps every bit.
    static const Ways same{Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity()};
    static const Ways wide = ways_of(rec2020);
    static const Ways cinema = ways_of(p3);
    switch (primaries) {
        case Primaries::rec2020:
            return wide;
        case Primaries::p3:
            return cinema;
        case Primaries::rec709:
            break;
    }
    return same;
}

}  // namespace

const Eigen::Matrix3d& rec709_from(Primaries primaries) {
    return ways_of(primaries).to_rec709;
}

const Eigen::Matrix3d& from_rec709(Primaries primaries) {
    return ways_of(primaries).from_rec709;
}

const char* name_of(Primaries primaries) {
    switch (primaries) {
        case Primaries::rec2020:
            return "Rec.2020";
        case Primaries::p3:
            return "P3";
        case Primaries::rec709:
            break;
    }
    return "Rec.709";
}

}  // namespace matchlight
