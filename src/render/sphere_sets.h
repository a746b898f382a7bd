// The sets of spheres of a scene, and which of all their spheres each pixel sees.
//
// Spheres are ray-cast where their bounds are drawn, so that silhouettes and depths are those of spheres in perspective
// (Sigg, Weyrich, Botsch & Gross 2006, "GPU-Based Ray-Casting of Quadratic Surfaces"; Gumhold 2003, "Splatting
// Illuminated Ellipsoids with Depth Correction"). First only which sphere is nearest is found; it is lit once a pixel,
// afterwards. The double-precision reference is report/sphere_reference.h.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gl/framebuffer.h"
#include "gl/shader_library.h"
#include "render/sphere_culling.h"
#include "render/sphere_geometry.h"
#include "render/sphere_rays.h"

namespace matchlight {

/// A set as one picture sees it.
struct PlacedSpheres {
    std::size_t set = 0;
    Eigen::Matrix4d world_from_model = Eigen::Matrix4d::Identity();
    Eigen::Matrix4d clip_from_world = Eigen::Matrix4d::Identity();  // a perspective
    SphereDetail detail = {};
};

/// Textures whose top-left part is the picture; they hold until the next one of the same kind.
struct SeenSpheres {
    const Texture2D* id = nullptr;           // SphereSets::first_id() + the sphere's number, 0 where none is; R32UI
    const Texture2D* depth_share = nullptr;  // near_m / z
};

/// A projection into whatever is bound, with the state that is set.
struct SphereCast {
    SphereProjection view;
    std::string fragment;                  // a shader that includes spheres/meet.glsl
    std::function<void(Program&)> set_up;  // its other uniforms; may be empty
    const Texture2D* depth = nullptr;  // the depth buffer that is bound: hidden spheres are passed over; may be null
};

class SphereSets {
public:
    explicit SphereSets(ShaderLibrary& shaders) : shaders_(shaders), culling_(shaders) {}

    /// Returns its index. Throws InputError when there are more spheres than the driver or 32 bits can hold.
    std::size_t add(const SphereSet& set);
    const SphereGeometry& geometry(std::size_t set) const { return *sets_.at(set).geometry; }
    /// Of its first sphere, in the order of its cells; never 0.
    std::uint32_t first_id(std::size_t set) const { return sets_.at(set).first_id; }

    /// The nearest sphere of each pixel; with `nearer_share` the nearest one behind that depth.
    SeenSpheres see(std::span<const PlacedSpheres> placed, int width, int height,
                    const Texture2D* nearer_share = nullptr);
    /// Of the pixels that `covered` (its alpha) covers less than `enough`, the next sphere behind the one that see() or
    /// see_next() found last; of spheres at one depth the next of the list.
    SeenSpheres see_next(std::span<const PlacedSpheres> placed, int width, int height, const Texture2D& covered,
                         double enough);
    /// Every sphere of the sets that culling leaves, into whatever is bound, with the state that is set.
    struct EachDraw {
        std::span<const PlacedSpheres> placed;
        int width = 0, height = 0;
        std::string fragment;  // a shader that includes spheres/meet.glsl
        ShaderDefines defines;
        std::function<void(Program&)> set_up;  // its other uniforms; may be empty
        const Texture2D* depth = nullptr;      // the depth buffer that is bound: hidden spheres are passed over
        const Texture2D* peeled = nullptr;     // of the layer before: spheres before it are passed over; null: none is
        bool depth_is_cleared = false;         // nothing is drawn there yet
    };
    void draw_each(const EachDraw& drawn);
    /// Draws a set along a light's rays.
    void cast(std::size_t set, const Eigen::Matrix4d& world_from_model, const SphereCast& cast);

    SphereVisibility visibility;  // for what is drawn from now on
    const SphereCulling& culling() const { return culling_; }

private:
    struct Set {
        std::unique_ptr<SphereGeometry> geometry;
        std::uint32_t first_id = 1;
    };
    struct Targets {
        Texture2D id, depth;
        Framebuffer target;

        void fit(int width, int height);
    };

    /// How the spheres that are looked for differ from all.
    struct Sought {
        const char* define = nullptr;  // of spheres/visible.frag; null: none
        std::function<void(Program&)> set_up = {};
        std::function<void()> begin = {};   // draws into the target before them
        const Texture2D* peeled = nullptr;  // the depth of the layer before
    };
    void draw(std::span<const PlacedSpheres> placed, int width, int height, Targets& targets, const Sought& sought);

    ShaderLibrary& shaders_;
    std::vector<Set> sets_;
    std::uint32_t next_id_ = 1;
    Targets nearest_, behind_;
    std::array<Targets, 2> peeled_;  // in turn
    const Targets* last_ = nullptr;  // what see() or see_next() drew last
    SphereCulling culling_;
    FullScreenTriangle triangle_;
};

}  // namespace matchlight
