// Analytic lights on the GPU, and depth maps of what stands in their light.
//
// Falloff and cones are those of glTF's KHR_lights_punctual; a lamp with a size is a ball, or a disc in the sky, that
// shines evenly. Its shadow on objects is found by rays, or by percentage-closer soft shadows in one map that looks at
// the casters (Reeves, Salesin & Cook 1987, "Rendering Antialiased Shadows with Depth Maps"; Fernando 2005,
// "Percentage-Closer Soft Shadows"). The double-precision reference is report/lamp_reference.h.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "gl/objects.h"
#include "gl/program.h"
#include "gl/shader_library.h"
#include "render/effects/contact_shadow.h"
#include "scene/lamp.h"

namespace matchlight {

struct LampQuality {
    int resolution = 1024;    // texels along a map's side, 16..4096
    int taps = 24;            // of each search in a map, of lamps that are no points, 1..256
    int rays = 8;             // towards such a lamp, 1..1024; 0: none are traced
    int surface_points = 64;  // of such a lamp, for its shadow on the real surface, 1..4096

    /// Throws std::invalid_argument naming the value that is out of range.
    void check() const;
};

/// Irradiance of what faces a lamp at a point that sees it, and where it comes from: what shaders/common/lamps.glsl
/// says.
struct LampArrival {
    Eigen::Vector3d to_lamp = Eigen::Vector3d::UnitZ();
    Eigen::Vector3d irradiance = Eigen::Vector3d::Zero();
};
LampArrival lamp_arrival(const LampSettings& lamp, const Eigen::Vector3d& world_position_m);

class Lamps {
public:
    explicit Lamps(std::span<const LampSettings> lamps);

    const std::vector<LampSettings>& settings() const { return lamps_; }

    /// Draws the casters from every lamp that casts shadows. Without `meshes` only spheres: rays meet the rest.
    void draw_maps(ShaderLibrary& shaders, const ShadowCasters& casters, const LampQuality& quality, bool meshes);

    /// Sets the uniforms of common/lamps.glsl and common/lamp_shadow.glsl, but for what is known of the surface.
    void bind(Program& program) const;
    static constexpr GLuint map_unit = 42;

private:
    void upload();
    /// What the faces of a lamp's map see of the casters; empty where it meets none.
    std::vector<Eigen::Matrix4d> faces_of(const LampSettings& lamp, const Eigen::AlignedBox3d& casters_m) const;

    std::vector<LampSettings> lamps_;
    std::vector<std::vector<Eigen::Matrix4d>> faces_;  // of each
    int taps_ = 1, rays_ = 0;
    Texture2D depth_;
    Buffer uniforms_;
};

}  // namespace matchlight
