// Boxes are walked nearer child first; spheres are met in the set's own axes, where their numbers are exact.
#include "scene/sphere_caster.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <span>

#include <Eigen/Geometry>

#include "scene/box_split.h"

namespace matchlight {
namespace {

/// More would test many spheres in vain, fewer would take more memory than the spheres themselves.
constexpr std::size_t most_in_leaf = 6;
/// Parts deeper than that are cut in the middle, which takes at most 32 cuts more.
constexpr int most_cut_by_area = 200;
constexpr std::size_t most_waiting = most_cut_by_area + 34;

Eigen::Vector3f centre_of(const Sphere& sphere) {
    return Eigen::Vector3f(sphere.centre_m.data());
}

/// Rounded outward: half a unit in the last place of its corners is inside.
Eigen::AlignedBox3f box_of(const Sphere& sphere) {
    const Eigen::Vector3f centre = centre_of(sphere);
    Eigen::AlignedBox3f box;
    for (int axis = 0; axis < 3; ++axis) {
        box.min()[axis] = std::nextafter(centre[axis] - sphere.radius_m, -std::numeric_limits<float>::infinity());
        box.max()[axis] = std::nextafter(centre[axis] + sphere.radius_m, std::numeric_limits<float>::infinity());
    }
    return box;
}

/// Where the ray enters the box; infinite where it passes by.
double entry(const Eigen::AlignedBox3f& box, const SphereRay& ray, const Eigen::Vector3d& inverse) {
    double near = ray.least, far = ray.most;
    for (int axis = 0; axis < 3; ++axis) {
        double a = (box.min()[axis] - ray.origin_m[axis]) * inverse[axis];
        double b = (box.max()[axis] - ray.origin_m[axis]) * inverse[axis];
        if (a > b) std::swap(a, b);
        // A ray within a face's plane gives 0 · ∞ = NaN, which leaves the bounds as they are.
        if (a > near) near = a;
        if (b < far) far = b;
    }
    // Spheres that touch their box may be met a rounding outside of it.
    constexpr double slack = 1 + 1e-14;
    return near <= far * slack ? near : std::numeric_limits<double>::infinity();
}

}  // namespace

std::optional<std::array<double, 2>> sphere_roots(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                                                  const Eigen::Vector3d& centre_m, double radius_m) {
    const Eigen::Vector3d from_centre = origin_m - centre_m;
    const double a = direction.squaredNorm();
    const double b = -from_centre.dot(direction);
    // The distance of the ray from the centre is found from the point nearest to it, not as a difference of squares.
    const double discriminant = radius_m * radius_m - (from_centre + b / a * direction).squaredNorm();
    if (discriminant < 0) return std::nullopt;
    const double distance = from_centre.norm();
    const double c = (distance - radius_m) * (distance + radius_m);
    const double q = b + std::copysign(std::sqrt(a * discriminant), b);
    if (q == 0) return std::array{0.0, 0.0};  // it touches at its origin
    const double one = c / q, other = q / a;
    return std::array{std::min(one, other), std::max(one, other)};
}

void SphereCaster::add_node(PlacedSet& placed, std::size_t first, std::size_t count, int depth) {
    const std::vector<Sphere>& spheres = placed.set->spheres;
    const std::span<std::uint32_t> part = std::span(placed.order).subspan(first, count);
    const std::size_t index = placed.nodes.size();
    Node node;
    for (const std::uint32_t one : part) node.box.extend(box_of(spheres[one]));
    placed.nodes.push_back(node);
    if (count <= most_in_leaf) {
        placed.nodes[index].count = static_cast<std::uint32_t>(count);
        placed.nodes[index].second_child = static_cast<std::uint32_t>(first);
        return;
    }
    const std::size_t left = depth > most_cut_by_area
                                 ? count / 2
                                 : split_by_area(
                                       part, [&](std::uint32_t one) { return box_of(spheres[one]); },
                                       [&](std::uint32_t one) { return centre_of(spheres[one]); });
    add_node(placed, first, left, depth + 1);
    placed.nodes[index].second_child = static_cast<std::uint32_t>(placed.nodes.size());
    add_node(placed, first + left, count - left, depth + 1);
}

void SphereCaster::add_set(const SphereSet& set, const RigidTransform& world_from_set, double scale) {
    assert(scale > 0 && set.size() < std::numeric_limits<std::uint32_t>::max());
    PlacedSet& placed = sets_.emplace_back();
    placed.set = &set;
    placed.world_from_set = world_from_set;
    placed.set_from_world = world_from_set.inverse();
    placed.scale = scale;
    placed.order.resize(set.size());
    std::iota(placed.order.begin(), placed.order.end(), 0U);
    if (!placed.order.empty()) add_node(placed, 0, placed.order.size(), 0);
}

template <class Visit>
bool SphereCaster::traverse(std::uint32_t set, SphereRay& ray, Surfaces surfaces, const Visit& visit) const {
    const PlacedSet& placed = sets_[set];
    if (placed.nodes.empty()) return true;
    // Multiples of the direction are the same in the set's own axes.
    SphereRay local = ray;
    local.origin_m = placed.set_from_world * ray.origin_m / placed.scale;
    local.direction = placed.set_from_world.linear() * ray.direction / placed.scale;
    const Eigen::Vector3d inverse = local.direction.cwiseInverse();
    struct Waiting {
        std::uint32_t node;
        double entry;
    };
    std::array<Waiting, most_waiting> stack;
    std::size_t waiting = 0;
    const auto push = [&](std::uint32_t node, double at) {
        if (at > ray.most || std::isinf(at)) return;
        assert(waiting < most_waiting);
        stack[waiting++] = {node, at};
    };
    push(0, entry(placed.nodes[0].box, local, inverse));
    while (waiting > 0) {
        const Waiting next = stack[--waiting];
        local.most = ray.most;
        if (next.entry > local.most) continue;
        const Node& node = placed.nodes[next.node];
        if (node.count == 0) {
            const std::uint32_t first = next.node + 1, second = node.second_child;
            const double first_entry = entry(placed.nodes[first].box, local, inverse);
            const double second_entry = entry(placed.nodes[second].box, local, inverse);
            const bool first_is_nearer = first_entry <= second_entry;
            push(first_is_nearer ? second : first, std::max(first_entry, second_entry));
            push(first_is_nearer ? first : second, std::min(first_entry, second_entry));
            continue;
        }
        for (std::uint32_t i = 0; i < node.count; ++i) {
            const std::uint32_t index = placed.order[node.second_child + i];
            const Sphere& sphere = placed.set->spheres[index];
            const auto roots = sphere_roots(local.origin_m, local.direction, centre_of(sphere).cast<double>(),
                                            static_cast<double>(sphere.radius_m));
            if (!roots) continue;
            for (const double root : *roots) {
                if (!(root > ray.least) || root > ray.most) continue;
                if (!visit(SphereHit{root, set, index})) return false;
                if (surfaces == Surfaces::first) break;
            }
        }
    }
    return true;
}

std::optional<SphereHit> SphereCaster::nearest(const SphereRay& ray) const {
    std::optional<SphereHit> found;
    SphereRay left = ray;
    for (std::uint32_t set = 0; set < sets_.size(); ++set) {
        traverse(set, left, Surfaces::first, [&](const SphereHit& hit) {
            if (!found || hit < *found) {
                found = hit;
                left.most = hit.distance;
            }
            return true;
        });
    }
    return found;
}

bool SphereCaster::meets(const SphereRay& ray, const SphereHit* own) const {
    SphereRay whole = ray;
    for (std::uint32_t set = 0; set < sets_.size(); ++set) {
        const bool free = traverse(set, whole, Surfaces::first, [&](const SphereHit& hit) {
            return own != nullptr && hit.same_sphere(*own);  // goes on past it alone
        });
        if (!free) return true;
    }
    return false;
}

void SphereCaster::all(const SphereRay& ray, Surfaces surfaces, std::vector<SphereHit>& hits) const {
    hits.clear();
    SphereRay whole = ray;
    for (std::uint32_t set = 0; set < sets_.size(); ++set) {
        traverse(set, whole, surfaces, [&](const SphereHit& hit) {
            hits.push_back(hit);
            return true;
        });
    }
    std::ranges::sort(hits);
}

Eigen::Vector3d SphereCaster::normal_at(const SphereHit& hit, const Eigen::Vector3d& position_m) const {
    const PlacedSet& placed = sets_[hit.set];
    const Eigen::Vector3d centre = centre_of(placed.set->spheres[hit.sphere]).cast<double>();
    return placed.world_from_set.linear() * (placed.set_from_world * position_m / placed.scale - centre).normalized();
}

double SphereCaster::radius_m(const SphereHit& hit) const {
    const PlacedSet& placed = sets_[hit.set];
    return placed.scale * static_cast<double>(placed.set->spheres[hit.sphere].radius_m);
}

}  // namespace matchlight
