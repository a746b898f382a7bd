// Eigen's box hierarchy with the slab test and Möller & Trumbore's triangle.
#include "scene/ray_caster.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <unsupported/Eigen/BVH>

namespace matchlight {

/// Found by Eigen through its argument's namespace, hence not in an unnamed one.
struct RayTriangle {
    Eigen::Vector3d corner, edge1, edge2;
    int mesh = 0;
};

static Eigen::AlignedBox3d bounding_box(const RayTriangle& triangle) {
    Eigen::AlignedBox3d box(triangle.corner);
    box.extend(Eigen::Vector3d(triangle.corner + triangle.edge1));
    box.extend(Eigen::Vector3d(triangle.corner + triangle.edge2));
    return box;
}

namespace {

/// What Eigen's traversal asks of each box and triangle.
class NearestHit {
public:
    NearestHit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double least)
        : origin_(origin), direction_(direction), inverse_(direction.cwiseInverse()), least_(least) {}

    bool intersectVolume(const Eigen::AlignedBox3d& box) const {
        double near = least_, far = distance_;
        for (int axis = 0; axis < 3; ++axis) {
            double a = (box.min()[axis] - origin_[axis]) * inverse_[axis];
            double b = (box.max()[axis] - origin_[axis]) * inverse_[axis];
            if (a > b) std::swap(a, b);
            // A ray within a face's plane gives 0 · ∞ = NaN, which leaves the bounds as they are.
            if (a > near) near = a;
            if (b < far) far = b;
        }
        return near <= far;
    }

    /// Möller & Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection".
    bool intersectObject(const RayTriangle& triangle) {
        const Eigen::Vector3d p = direction_.cross(triangle.edge2);
        const double determinant = triangle.edge1.dot(p);
        if (determinant == 0) return false;
        const Eigen::Vector3d from_corner = origin_ - triangle.corner;
        const double u = from_corner.dot(p) / determinant;
        if (u < 0 || u > 1) return false;
        const Eigen::Vector3d q = from_corner.cross(triangle.edge1);
        const double v = direction_.dot(q) / determinant;
        if (v < 0 || u + v > 1) return false;
        const double distance = triangle.edge2.dot(q) / determinant;
        if (distance > least_ && distance < distance_) {
            distance_ = distance;
            mesh_ = triangle.mesh;
        }
        return false;  // go on: another may be nearer
    }

    std::optional<RayCaster::Hit> hit() const {
        if (std::isinf(distance_)) return std::nullopt;
        return RayCaster::Hit{distance_, mesh_};
    }

private:
    Eigen::Vector3d origin_, direction_, inverse_;
    double least_;
    double distance_ = std::numeric_limits<double>::infinity();
    int mesh_ = -1;
};

}  // namespace

struct RayCaster::Tree {
    std::vector<RayTriangle> triangles;
    int meshes = 0;
    Eigen::AlignedBox3d bounds;
    Eigen::KdBVH<double, 3, RayTriangle> boxes;
};

RayCaster::RayCaster() : tree_(std::make_unique<Tree>()) {}
RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

void RayCaster::add_mesh(std::span<const Eigen::Vector3d> positions_m, std::span<const std::uint32_t> indices) {
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const Eigen::Vector3d& a = positions_m[indices[i]];
        const RayTriangle triangle{a, positions_m[indices[i + 1]] - a, positions_m[indices[i + 2]] - a, tree_->meshes};
        tree_->bounds.extend(bounding_box(triangle));
        tree_->triangles.push_back(triangle);
    }
    ++tree_->meshes;
}

void RayCaster::build() {
    if (!tree_->triangles.empty()) tree_->boxes.init(tree_->triangles.begin(), tree_->triangles.end());
    tree_->triangles = {};
}

std::optional<RayCaster::Hit> RayCaster::nearest(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                                                 double least_m) const {
    NearestHit query(origin_m, direction, least_m);
    if (tree_->bounds.isEmpty() || !query.intersectVolume(tree_->bounds)) return std::nullopt;
    Eigen::BVIntersect(tree_->boxes, query);
    return query.hit();
}

}  // namespace matchlight
