// What lens and shutter do to the virtual layer before it meets the plate, as the scene asks for it.
#pragma once

#include <optional>
#include <vector>

#include "compositor/focus.h"
#include "gl/shader_library.h"
#include "render/composite_pass.h"
#include "render/effects/defocus_gather.h"
#include "render/graph.h"
#include "render/virtual_layer.h"
#include "scene/effects.h"

namespace matchlight {

/// An object that is blurred as if the lens were focused elsewhere, or not at all.
struct ObjectFocus {
    std::size_t object = 0;
    std::optional<double> distance_m;  // absent: sharp
};

/// What is out of focus in a frame.
struct FrameDefocus {
    DepthOfFieldSettings settings;
    CocRange objects;                  // over all objects in view
    std::vector<ObjectFocus> apart{};  // objects with a focus of their own
};

/// What a frame's layer goes through; nothing where all is sharp and still.
struct LayerEffectPlan {
    std::optional<FrameDefocus> defocus;

    bool any() const { return defocus.has_value(); }
    /// How far, in plate pixels, the layer's light leaves the place it was drawn at.
    double spread_px() const;
    /// Whether the layer is drawn from many points of the lens instead of being blurred afterwards.
    bool samples_lens() const;
    /// Whether what the nearest surface hides is drawn, too.
    bool needs_hidden(QualityLevel quality) const;
};

struct LayerEffectInput {
    ShaderLibrary& shaders;
    CompositePass& composite;
    GatherDefocus& gather;
    const CompositeInput& input;  // with the layer as drawn
    double layer_density = 1;     // layer pixels along a plate pixel
    Region objects;               // plate pixels that the blurred layer can reach
    QualityLevel quality = QualityLevel::final_;
};

/// Adds the passes that `plan` asks for.
PlateLayer add_layer_effects(RenderGraph& graph, const LayerEffectInput& input, const LayerEffectPlan& plan);

}  // namespace matchlight
