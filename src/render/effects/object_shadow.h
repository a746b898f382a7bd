// How much of the probe's light reaches a point of a virtual object past the objects themselves.
//
// The whole sphere of light is split into directions (Debevec 2005, "A Median Cut Algorithm for Light Probe Sampling"),
// each with an orthographic depth map around the casters (Williams 1978, "Casting Curved Shadows on Curved Surfaces");
// what a point's hemisphere loses is weighed by each direction's light and cosine, so that one mechanism gives shadows
// between objects, on themselves, and ambient occlusion. Light that comes up from the surface is dimmed by the
// contact shadow where it left.
//
// Holdouts cast on objects like these do. On holdouts themselves the share is light with the objects over light
// without, and both without what real things shade, for the plate shows that already: the ratio that dims the plate.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "gl/objects.h"
#include "gl/program.h"
#include "gl/shader_library.h"
#include "lighting/probe.h"
#include "render/effects/contact_shadow.h"

namespace matchlight {

struct ObjectShadowSettings {
    int directions = 64;   // strata over the whole sphere, 1..256; 0 = objects cast nothing on objects
    int resolution = 256;  // texels along each side of a direction's map, 16..2048
    /// In place of strata the corners of an octahedron that is divided so often, 0..4
    /// (lighting/octahedral_directions.h): two that are opposite share one map, drawn once, of what is nearest to
    /// either.
    std::optional<int> octahedron_divisions = {};

    bool any() const { return directions > 0 || octahedron_divisions.has_value(); }
    /// Throws std::invalid_argument naming the value that is out of range.
    void check() const;
};

/// Static casters under static light need no other maps.
class ObjectShadow {
public:
    ObjectShadow(ShaderLibrary& shaders, const ShadowCasters& casters, const std::vector<DirectionalSample>& samples,
                 const ObjectShadowSettings& settings);

    /// Sets the uniforms of effects/object_shadow/object_shadow.glsl; takes one texture unit. No real thing shades.
    void bind(Program& program, GLuint unit) const;
    /// After another's bind(): this one's casters are real things, their directions the same.
    void bind_as_real(Program& program, GLuint unit) const;

    int directions() const { return directions_; }

private:
    /// Of a direction and, where they are paired, of its opposite.
    void draw_map(ShaderLibrary& shaders, const ShadowCasters& casters, const Eigen::Vector3d& to_light, int layer);
    SphereProjection map_view(const Eigen::Vector3d& to_light, const Eigen::Vector3d& axis_u,
                              const Eigen::Vector3d& axis_v) const;

    /// An array: height towards the light, 0..1 over the bounding sphere. One layer a direction, or (RG) a pair.
    Texture2D depth_;
    Texture2D one_;  // a map that is no array, in which is found which spheres are hidden
    Buffer lights_;  // a direction: towards the light, its light, the map's two axes
    bool is_paired_ = false;
    Eigen::Vector3d centre_m_ = Eigen::Vector3d::Zero();
    double radius_m_ = 0;
    int directions_ = 0;
    int resolution_ = 0;
};

}  // namespace matchlight
