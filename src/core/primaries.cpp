// Matrices from chromaticities (SMPTE RP 177:1993, "Derivation of Basic Television Color Equations").
#include "core/primaries.h"

#include <array>
#include <utility>

#include <Eigen/LU>

namespace matchlight {

namespace {

constexpr std::array<double, 2> d65{0.3127, 0.3290};

/// CIE x and y of red, green and blue.
using Chromaticities = std::array<std::array<double, 2>, 3>;
constexpr Chromaticities rec709_colors{{{0.640, 0.330}, {0.300, 0.600}, {0.150, 0.060}}};   // ITU-R BT.709
constexpr Chromaticities rec2020_colors{{{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}}};  // ITU-R BT.2020
constexpr Chromaticities p3_colors{{{0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}}};       // SMPTE EG 432-1

Eigen::Vector3d xyz_of(const std::array<double, 2>& xy) {
    return {xy[0] / xy[1], 1, (1 - xy[0] - xy[1]) / xy[1]};
}

Eigen::Matrix3d xyz_from(const Chromaticities& chromaticities, const std::array<double, 2>& white) {
    Eigen::Matrix3d colors;
    for (int i = 0; i < 3; ++i) colors.col(i) = xyz_of(chromaticities[static_cast<std::size_t>(i)]);
    const Eigen::Vector3d amounts = colors.inverse() * xyz_of(white);
    return colors * amounts.asDiagonal();
}

Eigen::Matrix3d to_rec709_from(const Chromaticities& chromaticities) {
    return xyz_from(rec709_colors, d65).inverse() * xyz_from(chromaticities, d65);
}

}  // namespace

Primaries::Primaries(const Eigen::Matrix3d& rec709_from, std::string name)
    : standard_(rec709),
      given_(std::make_shared<const Ways>(Ways{rec709_from, rec709_from.inverse(), std::move(name)})) {}

const Primaries::Ways& Primaries::ways() const {
    // Exactly the identity, so that footage of Rec.709 keeps every bit.
    static const Ways same{Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity(), "Rec.709"};
    static const Ways wide{to_rec709_from(rec2020_colors), to_rec709_from(rec2020_colors).inverse(), "Rec.2020"};
    static const Ways cinema{to_rec709_from(p3_colors), to_rec709_from(p3_colors).inverse(), "P3"};
    if (given_) return *given_;
    switch (standard_) {
        case rec2020:
            return wide;
        case p3:
            return cinema;
        case rec709:
            break;
    }
    return same;
}

bool Primaries::operator==(const Primaries& other) const {
    if (!given_ && !other.given_) return standard_ == other.standard_;
    return ways().to_rec709 == other.ways().to_rec709;
}

std::string Primaries::name() const {
    return ways().name;
}

Eigen::Matrix3d rec709_from_aces2065() {
    constexpr Chromaticities ap0{{{0.7347, 0.2653}, {0, 1}, {0.0001, -0.0770}}};
    constexpr std::array<double, 2> aces_white{0.32168, 0.33767};
    Eigen::Matrix3d bradford;
    bradford << 0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296;
    const Eigen::Vector3d gain = (bradford * xyz_of(d65)).cwiseQuotient(bradford * xyz_of(aces_white));
    const Eigen::Matrix3d adapted = bradford.inverse() * gain.asDiagonal() * bradford;
    return xyz_from(rec709_colors, d65).inverse() * adapted * xyz_from(ap0, aces_white);
}

}  // namespace matchlight
