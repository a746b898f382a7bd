// The passes of one frame: from what virtual things can reach to pictures that are read back.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "compositor/camera_effects.h"
#include "compositor/clip_light.h"
#include "compositor/clipped_plate.h"
#include "compositor/compositor.h"
#include "compositor/layer_effects.h"
#include "compositor/plate_behind.h"
#include "compositor/quality.h"
#include "compositor/reach.h"
#include "compositor/scene_objects.h"
#include "render/background.h"
#include "render/composite_pass.h"
#include "render/effects/grain.h"
#include "render/exchange_layers.h"
#include "render/graph.h"
#include "render/surface.h"
#include "render/surface_accumulator.h"

namespace matchlight {

/// An effect that the scene asks for and the frame does without.
struct LeftOutEffect {
    const char* name;
    const char* why;
};

/// What is known of a frame before anything is drawn.
struct FramePlan {
    FrameOptics optics;
    Eigen::AlignedBox2d object_bounds;   // of all virtual objects in view, normalised coordinates
    Eigen::AlignedBox2d holdout_bounds;  // of holdouts that can lie in shadow
    Reach reach;
    LayerEffectPlan layer_effects;
    std::optional<GrainModel> grain;
    std::function<bool(const Eigen::AlignedBox2d&)> in_shadow;  // parts of the surface; empty: there is none
    ImageF inverse_depth;  // 1/m of what the footage shows, over the frame, 0 where unknown; empty: not known
    ImageF matte;          // of what is real and in front, over the frame; empty: nothing
    std::vector<LeftOutEffect> left_out;
    std::optional<FrameShutter> neighbours;  // with CompositorOptions::exchange: where the frames beside it are
    bool posed = true;  // false: nothing virtual can be placed, and only the plate's own exposure may change
};

/// The objects as they were drawn for a frame, in textures that hold until others are drawn.
struct DrawnObjects {
    VirtualLayer layer, coverage_layer;
};

/// What frames share, and outlives them.
struct FrameResources {
    GlContext& context;
    ShaderLibrary& shaders;
    RenderGraph& graph;
    SurfaceRenderer& surfaces;
    SceneObjects& objects;
    GrainNoise& grain;
    ClipLight& light;
    CompositePass& composite;
    SurfaceAccumulator& accumulator;
    SurfaceAccumulator& holdout_accumulator;
    GatherDefocus& gather;
    SurfaceDefocus& surface_defocus;
    CameraEffects& effects;
    const Camera& camera;
    const LensMap& lens_map;
    const Quality& quality;
    std::optional<DrawnObjects>& drawn;         // that are not drawn again; empty: what is drawn is noted there
    const GatheredSurface* gathered = nullptr;  // what the clip shows of the surface
    const Background* background = nullptr;     // of a scene without footage
    Overscan overscan = {};
    bool timed = false;  // see RenderGraph::run
};

class FramePasses {
public:
    FramePasses(const FrameResources& resources, const FramePlan& plan) : resources_(resources), plan_(plan) {}

    /// Fills everything of `result` but its plate.
    void composite(CompositedFrame& result, const CompositorOptions& options);
    /// The frame's light, reduced to what exposure control meters.
    ImageF meter_map(const PlateFrame& plate);

private:
    /// Begins the frame in the graph, with the passes that draw objects and background.
    void begin(const PlateFrame& plate, bool layers);
    GraphTexture add_surface(bool layers);
    /// A picture of what lies in `bounds`, as a pinhole has it and without a lens; sets the layer's geometry.
    struct PlacedView {
        SurfaceView view;
        PinholeView pinhole;
        double layer_density = 1;  // pixels along a plate pixel
        Region plate;              // the pixels it covers
    };
    PlacedView place_view(Eigen::AlignedBox2d bounds, VirtualLayer& layer) const;
    /// Notes what was drawn.
    void keep_objects();
    void place_on_plate_pixels(const Eigen::AlignedBox2d& bounds, VirtualLayer& layer, SurfaceView& view) const;
    /// Of the view's part of the plate; null where depths are not known.
    std::optional<RealDepth> real_depth(const PlacedView& placed) const;
    /// Draws holdouts in the shadow of virtual objects.
    GraphTexture add_holdouts();
    /// Whether what is blurred afterwards has real things before it.
    bool parts_coverage() const;
    /// Whether what lets light through is drawn apart, to be blurred at its own depth.
    bool parts_transparent() const;
    /// For one picture of the layer that is blurred afterwards; none where nothing is.
    std::optional<SurfaceLens> surface_lens(double layer_density) const;
    /// From every point of the lens and at every time that the layer is drawn at: once, unless defocus or motion blur
    /// is drawn that way.
    SurfacePicture draw_surface(const PlacedView& placed, SurfaceAccumulator& sum,
                                const std::function<SurfacePicture(const SurfaceView&)>& draw);
    /// How objects move between two times in frames from the middle of the exposure.
    std::vector<ObjectWay> object_ways(const FrameShutter& shutter, std::array<double, 2> times) const;
    /// Between the opening of the shutter and its closing.
    std::vector<ObjectWay> shutter_ways() const;
    void draw_exchange(const SurfaceView& view);
    /// Adds what lens and shutter do to the layer to the composite's input.
    CompositeInput with_layer_effects(CompositeInput input);
    LayerEffectInput layer_effect_input(const CompositeInput& input, const Eigen::AlignedBox2d& bounds);
    /// Decoded in the runs alone; empty without footage.
    ImageF decoded_plate(const PlateFrame& plate, const Region& region, const std::vector<Region>& runs) const;
    /// Reads code values back as the result's picture.
    void take_picture(CompositedFrame& result, GraphTexture code, const std::vector<Region>& runs) const;
    /// What other frames know of clipped plate pixels under the shadow.
    void take_unclipped(CompositeInput& input, CompositedFrame& result);
    GraphTexture add_background();
    /// Of what is infinitely far away; nullopt where it is sharp.
    std::optional<EvenDisc> background_disc();
    /// Without effects or layers: code values in one pass.
    void composite_code(CompositedFrame& result);
    /// Light first, then what spills, then code values: with effects or layers.
    void composite_light(CompositedFrame& result, bool layers);
    void read_layers(CompositedFrame& result, const CompositePicture& picture, const ResponsePicture& shown,
                     const CompositeInput& input) const;
    /// Around what objects touch: where the spilled light can be seen.
    void composite_surroundings(CompositedFrame& result, GraphTexture spill, GraphTexture tiles);
    double least_visible_light(const CompositedFrame& frame) const;
    /// Adds the noise of a part of the frame; nullopt where it is left out.
    std::optional<FrameGrain> add_grain(const CompositedFrame& frame, const Region& region);
    /// Also adds what the real surface mirrors of objects.
    CompositeInput composite_input(const ImageF& plate_code, const Region& region, const std::vector<Region>& runs);

    FrameResources resources_;
    const FramePlan& plan_;
    /// What is behind things that let light through; nullopt where the probe says it.
    std::optional<PlateBehind> plate_behind(const PlateFrame& plate) const;
    /// What shades surfaces: the clip's light, and what the plate shows behind those that light passes.
    SurfaceShading shading() const;

    std::vector<PassInput> light_drawn_;       // what drawing surfaces reads
    std::optional<PlateBehind> plate_behind_;  // where something in view lets light through
    VirtualLayer layer_;
    VirtualLayer coverage_layer_;  // the same, its coverage in place of its light
    GraphTexture layer_drawn_;
    ClippedPlate clipped_plate_;
    VirtualLayer holdouts_;
    GraphTexture holdouts_drawn_;
    GraphTexture inverse_depth_;  // uploaded; empty where depths are not known
    GraphTexture background_;     // empty where there is footage
    std::optional<ExchangeLayers> exchange_;
};

/// Half a code value of the footage's depth, as a share of the brightest code. Response curves are steepest in relative
/// terms with exponent 1, so a shadow that takes this share of the light moves no code by more than a half.
double half_code(const PlateFormat& format);

}  // namespace matchlight
