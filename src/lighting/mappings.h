// How directions lie in the images that probes are kept in: lat-long, angular, mirror ball and cube, both ways.
//
// World axes everywhere: z up, y forward, x right. All images are images of directions, seen from inside: what lies to
// the right of forward lies to the right in the image. (A photograph of a mirror ball as taken is the mirror image of
// that, and its middle shows the camera.)
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/image.h"
#include "lighting/probe.h"

namespace matchlight {

/// How the six faces of a cube are laid out. Named by what they show (forward = world +y, up = world +z):
///   vertical_cross    3 × 4, after HDRShop:   . up .  /  left forward right  /  . down .  /  . back (upside down) .
///   horizontal_cross  4 × 3:                  . up . .  /  left forward right back  /  . down . .
///   strip             6 × 1, the order and face orientation of OpenGL cube maps: right left up down forward back
///                     (+X −X +Y −Y +Z −Z of a left-handed, y-up cube)
///   column            1 × 6, OpenEXR's ENVMAP_CUBE: +X −X +Y −Y +Z −Z of its right-handed, y-up frame that looks along
///                     +Z, which shows left right up down forward back; its up and down faces are turned by 180°
///                     against those of the others
enum class CubeLayout { vertical_cross, horizontal_cross, strip, column };

struct ProbeLayout {
    ProbeMapping mapping = ProbeMapping::latlong;
    CubeLayout cube = CubeLayout::vertical_cross;  // for ProbeMapping::cube
    int width = 0;
    int height = 0;
    /// OpenEXR's environment maps put the centres of the outermost pixels on the edge: in a lat-long map the first row
    /// is the pole, the first and last column are the same longitude; faces of a cube share their edge pixels.
    bool edge_centred = false;

    int face_size() const;  // of a cube, pixels
    bool operator==(const ProbeLayout&) const = default;
};

/// Angular and mirror-ball images: a disc that touches the image's sides.
bool is_disc(ProbeMapping mapping);

/// The layout of `mapping` at its natural shape for `size`: the height of a lat-long map, the side of an angular or
/// mirror-ball image, the side of a cube's face.
ProbeLayout layout_of_size(ProbeMapping mapping, int size, CubeLayout cube = CubeLayout::vertical_cross);

/// Which cube layout an image of this shape has; nullopt when none.
std::optional<CubeLayout> cube_layout_of_shape(int width, int height);

/// Continuous pixel coordinates (centres at whole numbers) of a direction, which need not have unit length. Straight
/// backwards is the whole rim of angular and mirror-ball images; its bottom is returned.
Eigen::Vector2d pixel_from_direction(const ProbeLayout& layout, const Eigen::Vector3d& direction);

/// The direction at continuous pixel coordinates; nullopt outside the disc or in the empty cells of a cross.
std::optional<Eigen::Vector3d> direction_from_pixel(const ProbeLayout& layout, const Eigen::Vector2d& pixel);

/// Steradians per square pixel at continuous pixel coordinates; 0 where there is no direction.
double solid_angle_density(const ProbeLayout& layout, const Eigen::Vector2d& pixel);

/// The pixel that stands for a direction. On a disc, pixels whose centre lies outside hold background, so the
/// nearest one inside is taken.
Eigen::Vector2i nearest_pixel(const ProbeLayout& layout, const Eigen::Vector3d& direction);

/// The largest angle, radians, between a direction and what its pixel shows: how far astray light may come out of the
/// layout.
double reach_of_pixel(const ProbeLayout& layout, const Eigen::Vector3d& direction);

/// A weighted pixel; weights of a set sum to 1.
struct PixelTap {
    int x = 0;
    int y = 0;
    double weight = 0;
};
/// The four pixels that are interpolated between for a direction: wrapped in longitude, kept within a cube's face and
/// within a disc.
std::array<PixelTap, 4> bilinear_taps(const ProbeLayout& layout, const Eigen::Vector3d& direction);

/// Steradians of every pixel, row by row: what part of the sphere nearest_pixel gives to it. Sums to 4π.
std::vector<double> pixel_solid_angles(const ProbeLayout& layout);

}  // namespace matchlight
