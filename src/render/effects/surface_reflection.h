// What a shiny real surface mirrors of the virtual objects, in the place of what it mirrored there before.
//
// At each plate pixel rays go from the surface along the lobe of a GGX surface (Walter et al. 2007, "Microfacet Models
// for Refraction through Rough Surfaces"). Where one meets an object it shows that object's light, and covers what the
// plate shows there: the probe's light along that ray, which is taken off the plate as the object's is put on.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Geometry>

#include "core/image.h"
#include "core/transforms.h"
#include "gl/shader_library.h"
#include "render/graph.h"

namespace matchlight {

struct SurfaceReflectionSettings {
    double reflectance = 0;  // of light that falls straight on, 0..1; 0 = it mirrors nothing
    double roughness = 0.1;  // perceptual, 0..1
    int rays = 8;            // a pixel, over its area and along the lobe, 1..1024

    /// Throws std::invalid_argument naming the value that is out of range.
    void check() const;
};

/// Directions of the lobe that are farther than this from the mirrored one are left out, and the rest stands for them:
/// a hundredth of the lobe. Radians; beyond a quarter turn the whole hemisphere is in it.
double lobe_reach(double roughness);

/// What is mirrored, where, and how the camera sees it.
struct MirroringSurface {
    Eigen::AlignedBox3d objects_m;  // around all that can be mirrored; not empty
    double z_m = 0;
    RigidTransform camera_from_world = RigidTransform::Identity();
    Region region;                                    // what the textures cover, in plate pixels
    std::vector<Region> runs;                         // the parts of it to draw
    std::vector<PassInput> light;                     // what the objects' light is made by
    ShaderDefines defines = {};                       // that the shadow on the surface asks for
    std::function<void(Program&)> bind_light;         // sets the uniforms of common/environment.glsl, visibility.glsl,
                                                      // near_light.glsl and object_light.glsl
    std::function<void(Program&, GLuint)> bind_lens;  // those of common/lens_map.glsl, with a texture unit
};

/// In probe units, over the region; empty where the pass was left out.
struct SurfaceReflection {
    GraphTexture objects;  // RGB: what the rays saw of objects; a: the weight of all rays
    GraphTexture covered;  // RGB: what the probe shows along those that met one
    GraphTexture shown;    // RGB: what the surface mirrors without objects; a: the share of light that it mirrors
    explicit operator bool() const { return static_cast<bool>(objects); }
};

SurfaceReflection add_surface_reflection(RenderGraph& graph, ShaderLibrary& shaders,
                                         const SurfaceReflectionSettings& settings, const MirroringSurface& surface);

}  // namespace matchlight
