// Rays against triangles in double precision, for references and autofocus.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace matchlight {

/// A hierarchy of boxes over triangles.
class RayCaster {
public:
    RayCaster();
    ~RayCaster();
    RayCaster(RayCaster&&) noexcept;
    RayCaster& operator=(RayCaster&&) noexcept;

    /// Every mesh is numbered in the order it was added.
    void add_mesh(std::span<const Eigen::Vector3d> positions_m, std::span<const std::uint32_t> indices);
    /// After the last mesh.
    void build();

    struct Hit {
        double distance_m = 0;  // in multiples of the direction's length
        int mesh = 0;
    };
    /// The nearest triangle, either side of it, farther than `least_m` along a direction (of which it is a multiple).
    std::optional<Hit> nearest(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction, double least_m) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace matchlight
