// Rays against sphere sets in double precision, for references and autofocus.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/transforms.h"
#include "scene/sphere_set.h"

namespace matchlight {

/// Where a ray meets a sphere, and which: its set by the order of adding, its number within.
struct SphereHit {
    double distance = 0;  // in multiples of the direction's length
    std::uint32_t set = 0, sphere = 0;

    /// Nearer ones first; of those at one distance the earlier set, then the lower number.
    auto operator<=>(const SphereHit&) const = default;  // NOLINT(modernize-use-nullptr): it takes <=> for a 0
    bool same_sphere(const SphereHit& other) const { return set == other.set && sphere == other.sphere; }
};

/// What a ray asks for: hits farther than `least` and not beyond `most`, in multiples of the direction.
struct SphereRay {
    Eigen::Vector3d origin_m = Eigen::Vector3d::Zero(), direction = Eigen::Vector3d::UnitZ();
    double least = 0, most = std::numeric_limits<double>::infinity();
};

/// Both roots of the ray in a sphere, the nearer first, by the form that holds for small and far and for huge and near
/// spheres (Haines, Günther & Akenine-Möller 2019, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing
/// Gems ch. 7). A ray that touches it has one root twice.
std::optional<std::array<double, 2>> sphere_roots(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                                                  const Eigen::Vector3d& centre_m, double radius_m);

/// A hierarchy of boxes over each of several sets, which stay where they are: 20 bytes a sphere beside them.
class SphereCaster {
public:
    /// The set must outlive this and not change.
    void add_set(const SphereSet& set, const RigidTransform& world_from_set = RigidTransform::Identity(),
                 double scale = 1);

    /// The surface met first: a sphere's front, or, from inside of it or where `least` cuts its front off, its back.
    std::optional<SphereHit> nearest(const SphereRay& ray) const;
    /// Whether anything is met; nothing of the sphere `own`, if given.
    bool meets(const SphereRay& ray, const SphereHit* own = nullptr) const;

    enum class Surfaces {
        first,  // of each sphere one, as `nearest` would meet it: a layer each, as impostors show them
        both
    };
    /// In the order of the ray. `hits` is emptied first, and only then allocates where it is too small.
    void all(const SphereRay& ray, Surfaces surfaces, std::vector<SphereHit>& hits) const;

    std::size_t set_count() const { return sets_.size(); }
    const SphereSet& set(std::uint32_t index) const { return *sets_[index].set; }
    /// Outward, of unit length, in the world.
    Eigen::Vector3d normal_at(const SphereHit& hit, const Eigen::Vector3d& position_m) const;
    /// In the world.
    double radius_m(const SphereHit& hit) const;

private:
    /// In depth-first order: after an inner node comes its first child.
    struct Node {
        Eigen::AlignedBox3f box;
        std::uint32_t second_child = 0;  // or the first sphere of a leaf in `order`
        std::uint32_t count = 0;         // of spheres; 0: an inner node
    };
    struct PlacedSet {
        const SphereSet* set = nullptr;
        RigidTransform world_from_set, set_from_world;
        double scale = 1;
        std::vector<Node> nodes;
        std::vector<std::uint32_t> order;
    };

    static void add_node(PlacedSet& placed, std::size_t first, std::size_t count, int depth);
    /// `visit(hit)` for every surface of the set within the ray, in no order; it may lower `ray.most` or end it all by
    /// returning false.
    template <class Visit>
    bool traverse(std::uint32_t set, SphereRay& ray, Surfaces surfaces, const Visit& visit) const;

    std::vector<PlacedSet> sets_;
};

}  // namespace matchlight
