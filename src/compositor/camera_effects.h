// The camera's effects of bright light, as the scene asks for them.
#pragma once

#include "gl/condition.h"
#include "gl/shader_library.h"
#include "render/frame_light.h"
#include "render/graph.h"
#include "scene/effects.h"

namespace matchlight {

class CameraEffects {
public:
    CameraEffects(ShaderLibrary& shaders, const EffectSettings& settings);

    /// Whether any of them spills light.
    bool any() const;
    /// Adds their passes; returns what they add to the picture (render/effects/spill.h), empty when nothing does.
    GraphTexture add(RenderGraph& graph, const FrameLight& light);
    /// Notes in the graph the effects that the scene does without.
    void explain(RenderGraph& graph) const;

    EffectSettings settings;

private:
    ShaderLibrary& shaders_;
};

}  // namespace matchlight
