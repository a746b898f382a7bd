// The solve's pair, or the settings' own.
#include "compositor/focus.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "compositor/nearest_known.h"
#include "render/virtual_layer.h"

namespace matchlight {

Focus focus_of_frame(const DepthOfFieldSettings& settings, const Solve& solve, const SolvedFrame& frame,
                     std::optional<double> focused_depth_m, Warnings& warnings) {
    std::optional<double> scale = settings.coc_scale_px_m, distance = focused_depth_m;
    if (!scale) scale = known_near(solve, frame, &SolvedFrame::coc_scale_px_m);
    if (!distance) distance = settings.focus_distance_m;
    if (!distance) distance = known_near(solve, frame, &SolvedFrame::focus_distance_m);
    if (!scale || !distance) {
        warnings.add(
            "depth of field is left out: neither the solve nor the scene says how far the lens is opened and where "
            "it is focused; give focus_distance_m and coc_scale_px_m");
        return {};
    }
    return {.coc_scale_px_m = *scale, .focus_distance_m = *distance};
}

namespace {

/// normal · point <= offset, in camera coordinates.
struct HalfSpace {
    Eigen::Vector3d normal;
    double offset = 0;
};

void add_box(std::vector<HalfSpace>& body, const Eigen::AlignedBox3d& box_world_m,
             const RigidTransform& camera_from_world) {
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d along = camera_from_world.linear().col(axis);
        const double origin = along.dot(camera_from_world.translation());
        body.push_back({along, box_world_m.max()[axis] + origin});
        body.push_back({-along, -box_world_m.min()[axis] - origin});
    }
}

/// Where points lie, before the focus, that some point of the opening sees in the frame: a circle's radius in
/// normalised coordinates is opening · (1/z − 1/z_f), so the frame's edge x₁ is met by x = x₁ z + opening (1 − z/z_f).
void add_view(std::vector<HalfSpace>& body, const Focus& focus, const FrameView& view) {
    const double opening_m = focus.coc_scale_px_m / (2 * view.focal_px);
    const double per_depth = opening_m / focus.focus_distance_m;
    for (int axis = 0; axis < 2; ++axis) {
        const Eigen::Vector3d along = Eigen::Vector3d::Unit(axis), ahead = Eigen::Vector3d::UnitZ();
        body.push_back({along - (view.normalized.max()[axis] - per_depth) * ahead, opening_m});
        body.push_back({-along + (view.normalized.min()[axis] + per_depth) * ahead, opening_m});
    }
}

bool holds(const std::vector<HalfSpace>& body, const Eigen::Vector3d& point) {
    constexpr double rounding_m = 1e-9;
    return std::ranges::all_of(body, [&](const HalfSpace& one) {
        return one.normal.dot(point) <= one.offset + rounding_m * (1 + std::abs(one.offset));
    });
}

/// The least depth of a convex body; infinite where it is empty. It is at a corner, where three of its planes meet.
double least_depth_m(const std::vector<HalfSpace>& body) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < body.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const Eigen::Vector3d line = body[i].normal.cross(body[j].normal);
            for (std::size_t k = 0; k < j; ++k) {
                const double determinant = line.dot(body[k].normal);
                constexpr double least_determinant = 1e-12;  // less: as good as parallel
                if (std::abs(determinant) < least_determinant) continue;
                const Eigen::Vector3d corner =
                    (body[k].offset * line + body[i].offset * body[j].normal.cross(body[k].normal) +
                     body[j].offset * body[k].normal.cross(body[i].normal)) /
                    determinant;
                if (corner.z() < least && holds(body, corner)) least = corner.z();
            }
        }
    }
    return least;
}

}  // namespace

CocRange coc_range_of_box(const Focus& focus, const Eigen::AlignedBox3d& box_world_m, const FrameView& view) {
    Eigen::Vector3d nearest(0, 0, std::numeric_limits<double>::infinity());
    double farthest_m = near_plane_m;
    for (int i = 0; i < 8; ++i) {
        const Eigen::Vector3d corner =
            view.camera_from_world * box_world_m.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
        if (corner.z() < nearest.z()) nearest = corner;
        farthest_m = std::max(farthest_m, corner.z());
    }
    if (nearest.z() < focus.focus_distance_m) {
        std::vector<HalfSpace> seen{{-Eigen::Vector3d::UnitZ(), -near_plane_m}};
        add_view(seen, focus, view);
        if (!holds(seen, nearest)) {
            add_box(seen, box_world_m, view.camera_from_world);
            // Where nothing of it before the focus is seen, no more than what is beyond counts.
            nearest.z() = std::min({least_depth_m(seen), focus.focus_distance_m, farthest_m});
        }
    }
    return {.nearest_px = signed_coc_px(focus, std::max(nearest.z(), near_plane_m)),
            .farthest_px = signed_coc_px(focus, farthest_m)};
}

}  // namespace matchlight
