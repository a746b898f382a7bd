// The light that a whole clip shares: its maps are made once, those of shadows anew where objects move.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compositor/quality.h"
#include "compositor/reach.h"
#include "compositor/scene_change.h"
#include "compositor/scene_objects.h"
#include "core/warnings.h"
#include "render/effects/contact_shadow.h"
#include "render/effects/object_shadow.h"
#include "render/effects/surface_reflection.h"
#include "render/environment.h"
#include "render/graph.h"
#include "render/lamps.h"
#include "render/surface.h"
#include "render/surface_picture_map.h"
#include "scene/scene_file.h"

namespace matchlight {

class ClipLight {
public:
    /// What is lit: `objects`, which `surfaces` holds, are there already and outlive this.
    struct Lit {
        SceneObjects& objects;
        SurfaceRenderer& surfaces;
        std::shared_ptr<const GatheredSurface> gathered_surface = {};  // null: the surface is as the probe saw it
    };
    /// Throws InputError where the probe cannot be read.
    ClipLight(ShaderLibrary& shaders, const Lit& lit, const Scene& scene, const Quality& quality, Warnings& warnings);

    /// The passes that make what the scene needs, drawn once over all frames; returns what drawing surfaces reads.
    std::vector<PassInput> add_passes(RenderGraph& graph);
    /// Objects stand otherwise than when the maps were made: lets the passes of shadows draw again, of the one on the
    /// surface only where `casters` moved. While dragging, the one between objects stays as it was.
    void forget_shadows(RenderGraph& graph, bool casters);
    /// The same objects and the same probe, otherwise turned, exposed or taken elsewhere, over another surface: lets
    /// all passes that this concerns draw again. Throws InputError.
    void set_scene(RenderGraph& graph, const Scene& scene, const SceneChange& change, Warnings& warnings);
    /// True: what is made from now on is coarse, and quickly made. False: what was made so draws again; returns whether
    /// there is any.
    bool set_dragging(RenderGraph& graph, bool dragging, Warnings& warnings);

    /// Turned and scaled as the scene says.
    const Probe& probe() const { return probe_; }
    const Environment& environment() const { return *environment_; }
    const std::optional<ContactShadow>& contact_shadow() const { return contact_shadow_; }
    const SurfaceShading& shading() const { return shading_; }
    /// The map that a pass of add_passes() made, for a look inside; nullopt where it made none that is a picture.
    std::optional<WatchedTexture> map_of(const std::string& pass) const;
    /// What the real surface mirrors of the objects; nullopt where it mirrors none, or no rays are traced.
    std::optional<MirrorReach> mirror_reach() const;
    /// The pass that draws it over the runs of a region, after `light` (of add_passes()); empty where it is left out.
    struct MirrorView {
        RigidTransform camera_from_world = RigidTransform::Identity();
        Region region;
        std::vector<Region> runs;
        std::vector<PassInput> light;
        std::function<void(Program&, GLuint)> bind_lens;
    };
    SurfaceReflection add_reflection(RenderGraph& graph, const MirrorView& view) const;

private:
    void make_environment(Warnings& warnings);
    void make_lamps(const Scene& scene, Warnings& warnings);
    /// Those of models stand where they stand now.
    void place_lamps();
    void add_lamps(RenderGraph& graph, std::vector<PassInput>& inputs);
    ShadowCasters casters();
    ShadowCasters real_casters();
    void add_environment(RenderGraph& graph, std::vector<PassInput>& inputs);
    void add_shadows(RenderGraph& graph, std::vector<PassInput>& inputs);
    void make_surface_shadow(const ContactShadowSettings& settings);
    /// What shaders of light are compiled with that look the shadow on the surface up.
    ShaderDefines shadow_defines() const { return lamps_ ? ShaderDefines{{"LAMPS", "1"}} : ShaderDefines{}; }
    /// Of what casts rays, too.
    ShaderDefines ray_defines() const;
    bool bounces() const;
    void restore_cast_shadow();
    void bake_object_shadow();
    void add_bounces(RenderGraph& graph, std::vector<PassInput>& inputs);
    void bounce_light();
    void describe_surface();
    void bind_shading(Program& program) const;
    const SurfaceLight& surface_light(int directions);
    const std::vector<DirectionalSample>& object_light();

    ShaderLibrary& shaders_;
    SceneObjects& objects_;
    SurfaceRenderer& surfaces_;
    RayScene* rays_;  // null: none are traced
    SurfaceSettings surface_;
    std::optional<Eigen::Vector3d> probe_place_m_;
    Quality quality_;
    std::string shadows_hold_for_;         // what the maps of shadows are made once for
    std::optional<Probe> unplaced_probe_;  // kept once it was placed anew
    Probe probe_;
    std::unique_ptr<Environment> environment_;
    std::string probe_name_ = "probe";            // in warnings
    std::map<int, SurfaceLight> surface_lights_;  // by their directions
    std::optional<std::vector<DirectionalSample>> object_light_;
    bool dragging_ = false;
    bool coarse_environment_ = false, coarse_shadows_ = false;  // made while dragging
    std::optional<ContactShadow> cast_shadow_;                  // as cast; empty where no light bounces
    std::optional<ContactShadow> contact_shadow_;               // with what bounces to the surface
    // Kept where there are spheres, which look at them in every pixel.
    std::optional<ObjectShadow> object_shadow_, real_shadow_;
    SurfacePictureMap surface_picture_;
    std::vector<LampSettings> scene_lamps_;
    std::optional<Lamps> lamps_;      // with those of models
    bool shadow_has_bounce_ = false;  // contact_shadow_ is no longer as cast
    bool has_visibility_ = false;     // baked at the vertices
    SurfaceShading shading_;
    Texture2D no_shadow_{TextureShape{.format = GL_RGBA32F, .width = 2, .height = 2}};
};

}  // namespace matchlight
