// Which plate pixels a virtual thing can touch: screen bounds of world-space boxes and rectangles, through the lens.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "calibration/camera.h"
#include "compositor/lens_map.h"
#include "core/image.h"
#include "core/transforms.h"

namespace matchlight {

/// Bounds of a convex body in normalised camera coordinates (x/z, y/z), cut at the near plane and `beyond` the lens
/// map's bounds; empty where no part of it is before the camera or in view. `edges` index into `corners_world_m`.
Eigen::AlignedBox2d normalized_bounds(const std::vector<Eigen::Vector3d>& corners_world_m,
                                      const std::vector<std::array<int, 2>>& edges,
                                      const RigidTransform& camera_from_world, const LensMap& lens_map,
                                      double beyond = 0);

/// The same of a box and of a rectangle lying at height `z_m`.
Eigen::AlignedBox2d normalized_bounds_of_box(const Eigen::AlignedBox3d& box_world_m,
                                             const RigidTransform& camera_from_world, const LensMap& lens_map,
                                             double beyond = 0);
Eigen::AlignedBox2d normalized_bounds_of_rectangle(const Eigen::AlignedBox2d& rectangle_m, double z_m,
                                                   const RigidTransform& camera_from_world, const LensMap& lens_map);

/// The plate pixels that are at most `margin_px` from directions in `bounds`; of those beyond the frame, too, where the
/// lens goes on straight.
Region plate_region(const Eigen::AlignedBox2d& bounds, const Camera& camera, const LensMap& lens_map, int margin_px);

/// The part of a frame that virtual things can touch, as horizontal runs of square tiles: only these are drawn, read
/// back and converted.
struct Reach {
    static constexpr int tile_px = 32;
    std::vector<Region> runs;  // disjoint, cut to the frame
    Region bounds;             // around all of them

    std::int64_t pixels() const;
    /// Whether the tile in that column and row of the frame's tiles is part of it.
    bool has_tile(int column, int row) const;
};

/// All of a frame's tiles, row by row.
std::vector<Region> frame_tiles(const Camera& camera);

/// The tiles for which `wanted` says so, by column and row.
Reach tiles_of(const Camera& camera, const std::function<bool(int column, int row)>& wanted);

/// Whether a box of the real surface (world x, y) holds shadow.
using ShadowTest = std::function<bool(const Eigen::AlignedBox2d& box_m)>;

/// Where the real surface holds shadow.
struct ShadowReach {
    ShadowTest in = {};  // empty: nowhere
    double surface_z_m = 0;
    /// How far a tile's pixels look for it in the picture: by the camera's motion and out of focus. Empty: nowhere but
    /// where they are.
    std::function<int(const Region& tile)> spread_px = {};
    bool beyond_frame = false;  // whether they see, out of focus, what lies there
};

/// Whether a part of the frame sees shadow.
bool sees_shadow(const Region& part, const ShadowReach& shadow, const RigidTransform& world_from_camera,
                 const LensMap& lens_map, const Camera& camera);

/// A real surface that mirrors what lies in a box.
struct MirrorReach {
    Eigen::AlignedBox3d objects_m;  // not empty
    double surface_z_m = 0;
    double lobe_rad = 0;  // how far from the mirrored direction it looks
};

/// Whether a part of the frame can see something of the box mirrored: it may say so where nothing is seen, never the
/// other way round.
bool sees_mirrored(const Region& part, const MirrorReach& mirror, const RigidTransform& world_from_camera,
                   const LensMap& lens_map);

/// What can change a frame.
struct ReachSources {
    std::vector<Region> object_regions;
    ShadowReach shadow;
    std::optional<MirrorReach> mirror = {};
};

/// Tiles that lie in one of the objects' regions, see shadow on the surface or see objects mirrored there.
Reach make_reach(const ReachSources& sources, const RigidTransform& camera_from_world, const LensMap& lens_map,
                 const Camera& camera);

}  // namespace matchlight
