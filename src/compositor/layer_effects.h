// What lens and shutter do to the virtual layer before it meets the plate, as the scene asks for it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compositor/focus.h"
#include "compositor/shutter.h"
#include "compositor/surface_focus.h"
#include "compositor/virtual_motion.h"
#include "gl/shader_library.h"
#include "render/composite_pass.h"
#include "render/effects/chromatic_aberration.h"
#include "render/effects/color_transform.h"
#include "render/effects/defocus_gather.h"
#include "render/effects/repeated_blur.h"
#include "render/effects/softness.h"
#include "render/effects/surface_defocus.h"
#include "render/graph.h"
#include "render/virtual_layer.h"
#include "scene/effects.h"

namespace matchlight {

/// What is out of focus in a frame.
struct FrameDefocus {
    DepthOfFieldSettings settings;
    CocRange objects;                  // over all objects in view
    std::vector<ObjectFocus> apart{};  // objects with a focus of their own
    QualityLevel quality = QualityLevel::final_;
};

/// What of the shadow on the real surface is out of focus in a frame.
struct FrameSurfaceDefocus {
    SurfaceFocus focus;
    BokehSettings bokeh;
    std::vector<SurfaceTile> tiles;  // where the blurred shadow can be
    SurfaceDefocusKnobs knobs;
    double smooth_over_m = 0;  // ShadowDetail; 0: smooth parts are drawn as others

    /// Of a tile without the shadow's edges.
    int smooth_class_of(const Region& tile) const {
        return smooth_over_m > 0 ? focus.class_of_texels(tile, smooth_over_m) : 0;
    }
    /// How far a tile's pixels, or those up to `around_px` beside it, look for the shadow.
    int reach_px(const Region& tile, int around_px = 0) const;
};

/// What moves while a frame's shutter is open.
struct FrameMotion {
    MotionBlurSettings settings;
    FrameShutter shutter;
    MotionExtent objects;  // over all of them
    MotionExtent surface;  // of the real surface's shadow
    bool smears_objects = false, smears_shadow = false;
};

/// What a frame's layer goes through; nothing where all is sharp and still.
struct LayerEffectPlan {
    std::optional<FrameDefocus> defocus;
    std::optional<FrameSurfaceDefocus> surface_defocus;
    std::optional<FrameMotion> motion;
    std::string motion_left_out;  // why, where the scene asks for motion blur and the frame has none
    const ColorTransform* color_transform = nullptr;
    ColorTransformFrame color_frame;  // of that
    std::optional<RepeatedBlurSettings> repeated_blur;
    std::optional<LateralColor> color;
    double softness_px = 0;                              // standard deviation
    QualityLevel sensor_quality = QualityLevel::final_;  // of what follows lens and shutter

    bool any() const { return defocus || surface_defocus || motion || acts_on_plate_pixels(); }
    /// Whether something is done to the layer after lens and shutter have blurred it.
    bool acts_on_plate_pixels() const {
        return color_transform != nullptr || repeated_blur || color || softness_px > 0;
    }
    /// How far, in plate pixels, the layer's light leaves the place it was drawn at.
    double spread_px() const;
    /// Of that, what lens and shutter do, which also bring in what lies beyond the frame.
    double lens_spread_px() const;
    /// Whether the layer is drawn from many points of the lens instead of being blurred afterwards.
    bool samples_lens() const;
    /// Whether what the nearest surface hides is drawn, too.
    bool needs_hidden() const;
    /// Whether it is drawn at many times. Points of the lens each have a time of their own, whatever the level.
    bool samples_time() const;
    /// Pictures that are drawn of the layer.
    int samples() const;
    bool blurs_focus() const { return defocus && !samples_lens(); }
    bool gathers_motion() const { return motion && motion->smears_objects && !samples_time(); }
};

struct LayerEffectInput {
    ShaderLibrary& shaders;
    CompositePass& composite;
    GatherDefocus& gather;
    SurfaceDefocus& surface_defocus;
    const CompositeInput& input;  // with the layer as drawn
    /// The layer with the virtual things' coverage in place of its light, where real things count as covered; else
    /// null.
    const VirtualLayer* coverage = nullptr;
    double layer_density = 1;        // layer pixels along a plate pixel
    bool parts_transparent = false;  // the layer has them apart
    Region objects;                  // plate pixels that the blurred layer can reach
    QualityLevel motion_quality = QualityLevel::final_;
};

/// The layer on plate pixels after what `plan` says that lens and shutter do to it.
GraphTexture add_lens_and_shutter(RenderGraph& graph, const LayerEffectInput& input, const LayerEffectPlan& plan);

/// Adds the passes that `plan` asks for.
PlateLayer add_layer_effects(RenderGraph& graph, const LayerEffectInput& input, const LayerEffectPlan& plan);

}  // namespace matchlight
