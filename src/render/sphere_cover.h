// How much of a picture spheres may have covered, told on the CPU before they are drawn: what decides whether it is
// worth asking the GPU what they hide.
#pragma once

#include <vector>

#include <Eigen/Geometry>

namespace matchlight {

/// Where a cell of spheres is seen, and the discs that it shows there.
struct CellInPicture {
    Eigen::AlignedBox2d box_px;  // cut to the picture
    double discs_px = 0;         // the area of all, as if none hid another
};

/// The area of discs over the area of picture that they fall on, in tiles. Nothing is hidden where it is below 1, and
/// by spheres that lie by chance hardly where it is little more: by a depth of d of them e⁻ᵈ stays bare.
class SphereCover {
public:
    SphereCover(int width_px, int height_px);

    void add(const CellInPicture& cell);
    /// That something in front hides all of it.
    bool may_hide(const CellInPicture& cell) const;

private:
    /// Calls back with the index of each tile that the box touches, until it says false.
    template <class Each>
    void for_tiles(const Eigen::AlignedBox2d& box_px, const Each& each) const;

    Eigen::Array2d tile_px_;
    std::vector<double> depths_;
};

}  // namespace matchlight
