// Colours of red, green and blue light, and the way from one set of them to Rec.709's.
#pragma once

#include <memory>
#include <string>

#include <Eigen/Core>

namespace matchlight {

/// Of footage: standard ones, which have D65 as white, or any that a matrix describes. Grey stays grey.
class Primaries {
public:
    enum Standard { rec709, rec2020, p3 };

    Primaries(Standard standard = rec709) : standard_(standard) {}  // NOLINT: a standard is the usual way to say them
    /// Of light that this matrix makes Rec.709's; its rows sum to 1 and it has an inverse.
    Primaries(const Eigen::Matrix3d& rec709_from, std::string name);

    bool operator==(const Primaries& other) const;

    /// Linear light of Rec.709 from linear light of these, whose rows sum to 1, and its inverse. They live as long as
    /// any copy of these.
    friend const Eigen::Matrix3d& rec709_from(const Primaries& primaries) { return primaries.ways().to_rec709; }
    friend const Eigen::Matrix3d& from_rec709(const Primaries& primaries) { return primaries.ways().from_rec709; }
    /// "Rec.709", "Rec.2020", "P3", or as given.
    std::string name() const;

private:
    struct Ways {
        Eigen::Matrix3d to_rec709, from_rec709;
        std::string name;
    };
    const Ways& ways() const;

    Standard standard_;
    std::shared_ptr<const Ways> given_;
};

/// Declared here as well, so that the standard ones may be named alone.
const Eigen::Matrix3d& rec709_from(const Primaries& primaries);
const Eigen::Matrix3d& from_rec709(const Primaries& primaries);

/// Linear light of Rec.709 from ACES2065-1 (SMPTE ST 2065-1:2021, primaries AP0), whose white is adapted to D65 by
/// Bradford's cone responses (Lam 1985), as OpenColorIO's own configs do.
Eigen::Matrix3d rec709_from_aces2065();

}  // namespace matchlight
