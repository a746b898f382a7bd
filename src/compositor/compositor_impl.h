// What a compositor holds over the clip, and the steps that a frame takes.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "compositor/camera_effects.h"
#include "compositor/clip_light.h"
#include "compositor/compositor.h"
#include "compositor/frame_passes.h"
#include "compositor/lens_map.h"
#include "compositor/quality.h"
#include "compositor/reach.h"
#include "compositor/scene_focus.h"
#include "compositor/scene_objects.h"
#include "gl/shader_library.h"
#include "media/side_footage.h"
#include "render/composite_pass.h"
#include "render/surface.h"

namespace matchlight {

struct Compositor::Impl {
    Impl(GlContext& gl_context, const Scene& scene, const Solve& the_solve, const CompositorOptions& the_options,
         Warnings& the_warnings);

    void open_side_footage();
    void load_objects(Warnings& warnings);
    ObjectPreparation object_preparation(const Scene& scene) const;
    /// Where the clip begins: objects that move stand there at first.
    ClipTime start() const;
    bool set_scene(const Scene& changed);
    bool set_dragging(bool now);
    /// Whether `changed` needs another picture of the surface than the options gave.
    bool needs_other_surface(const Scene& changed, const SceneChange& change) const;
    /// Makes the light's maps, those that are there already excepted.
    void make_light();
    /// Puts objects where they are in the frame, and makes what is stale of their light.
    void place_objects(const SolvedFrame& frame);
    /// Before a frame is drawn: lets go of the objects that were drawn for another one, or of another scene.
    void keep_objects_of(std::int64_t frame);
    void prepare_composite(const PlateFormat& format);
    const Response& response_of(const PlateFormat& format) const;
    FrameOptics optics_of(const SolvedFrame& frame) const;
    /// What a frame needs drawn; nullopt where it stays as it came.
    std::optional<FramePlan> plan_of(const PlateFrame& plate, bool whole_frame);
    FrameResources resources();
    /// Sets the levels that the largest of some frames over the clip has time for.
    void keep_to_budget(const FrameBudget& budget);
    /// Also extends `object_bounds` (normalised coordinates) by every object in view.
    Reach reach_of(const RigidTransform& camera_from_world, const PlateFormat& format,
                   Eigen::AlignedBox2d& object_bounds, const LayerEffectPlan& spread = {});
    /// Of holdouts in view, in normalised coordinates; empty where nothing casts on them.
    Eigen::AlignedBox2d holdout_bounds(const RigidTransform& camera_from_world, const LayerEffectPlan& spread) const;
    /// Where the shadow on the real surface can be seen; nowhere where there is none.
    ShadowReach shadow_reach(const PlateFormat& format);
    /// Sets how the shadow is out of focus, or why it is not.
    void plan_surface_defocus(FramePlan& plan, const PlateFormat& format);
    /// Also sets how the lens is focused.
    LayerEffectPlan layer_effects_of(const SolvedFrame& frame, FrameOptics& optics);
    std::optional<FrameDefocus> defocus_of(const SolvedFrame& frame, FrameOptics& optics);
    /// `left_out` says why there is none where the scene asks for it.
    std::optional<FrameMotion> motion_of(const SolvedFrame& frame, std::string& left_out);
    /// What is done to the layer on plate pixels.
    void plan_sensor(FramePlan& plan);

    GlContext& context;
    Scene scene;
    Solve solve;
    CompositorOptions options;
    Quality quality;
    Warnings& warnings;
    std::optional<double> virtual_fps;  // of a scene without footage
    std::vector<std::string> object_names;
    ShaderLibrary shaders;
    SurfaceRenderer surfaces;
    std::optional<SceneObjects> scene_objects;
    RenderGraph graph;
    std::optional<ClipLight> light;
    bool light_is_stale = false;
    std::string watched_pass;
    std::optional<WatchedTexture> watched_map;        // of the light, which is made before the frame's passes
    bool dragging = false, surface_is_stale = false;  // the options' gathered surface, while dragging
    std::optional<LevelChoice> level_choice;          // by the budget
    std::optional<Background> background;             // of a scene without footage
    std::optional<ShadowDetail> shadow_detail;        // made with the first frame that is out of focus
    std::optional<ShadowFootprint> footprint;         // made with the first frame, whose depth sets the limit
    std::optional<MatteSource> matte;                 // of what is real and in front
    std::optional<DepthSource> depth;                 // of what the footage shows
    std::optional<DrawnObjects> drawn;                // of `drawn_frame`, for set_scene()
    std::int64_t drawn_frame = 0;
    bool spill_alone_changed = false;  // since they were drawn
    SceneFocus scene_focus;
    LensMap lens_map;
    std::unique_ptr<CompositePass> composite_pass;
    SurfaceAccumulator accumulator{shaders};
    SurfaceAccumulator holdout_accumulator{shaders};
    GatherDefocus gather{shaders};
    SurfaceDefocus surface_defocus{shaders};
    GrainNoise grain_noise{shaders};
    CameraEffects effects;
    Response pq = Response::pq();
    Response hlg = Response::hlg();
};

}  // namespace matchlight
