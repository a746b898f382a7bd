// A set of spheres as it lies on the GPU, in the order of its cells.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "gl/objects.h"
#include "gl/program.h"
#include "scene/sphere_cells.h"
#include "scene/sphere_set.h"

namespace matchlight {

/// The first of three: beyond those that light and materials have in the programs of surface shading.
inline constexpr GLuint sphere_geometry_unit = 27;

/// Spheres of a cell are halved so many times at the most, and those left enlarged to cover as much.
inline constexpr int most_detail_level = 7;
inline double radius_scale(int level) {
    return std::exp2(0.5 * level);
}

class SphereGeometry {
public:
    /// `set` is only read while adding. Throws InputError when the driver cannot hold as many.
    explicit SphereGeometry(const SphereSet& set);

    std::uint32_t size() const { return size_; }
    const std::vector<SphereCell>& cells() const { return cells_; }
    const Eigen::AlignedBox3d& bounds_m() const { return bounds_m_; }

    /// Vertex attribute 0 is a sphere, attribute 1 the scale of its radius, by the first instance: for points.
    void bind_points() const { points_.bind(); }
    /// Without attributes: for triangles, whose shader fetches spheres.
    void bind_triangles() const { triangles_.bind(); }
    /// `spheres` and, where spheres have colours and opacities of their own, `sphere_colors` and `sphere_opacities`:
    /// samplerBuffers from `sphere_geometry_unit`.
    void bind(Program& program) const;

private:
    std::uint32_t size_;
    std::vector<SphereCell> cells_;
    Eigen::AlignedBox3d bounds_m_;
    Buffer spheres_, colors_, opacities_, radius_scales_;
    BufferTexture sphere_texels_, color_texels_, opacity_texels_;
    VertexArray points_, triangles_;
    bool has_colors_ = false, has_opacities_ = false;
};

}  // namespace matchlight
